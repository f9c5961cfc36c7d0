#include "studio/campaigns.h"

#include <chrono>
#include <optional>
#include <vector>

#include "base/child_process.h"
#include "base/shell_word.h"
#include "base/text.h"

namespace studio {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::Result;

constexpr std::size_t max_row_bytes = std::size_t{4} << 20;  // of rows
constexpr std::chrono::minutes campaign_limit{1};            // the end of the studio waits as long

// Without the name of the program before it.
Result<std::string> output_of_rtse(std::vector<std::string> words) {
  words.insert(words.begin(), base::own_program("rtse"));
  auto said = base::output_of({std::move(words), {}, ""}, campaign_limit);
  if (said) return said;
  auto message = said.error().message;
  if (const auto own = message.find("rtse: "); own != std::string::npos) message.erase(0, own + 6);
  return Error{message};
}

// Folders are named row-NUMBER-KEY.
std::optional<std::int64_t> row_of(const std::string& name) {
  constexpr std::string_view prefix = "row-";
  if (!name.starts_with(prefix)) return std::nullopt;
  return base::parse_integer(std::string_view(name).substr(prefix.size(), name.find('-', prefix.size()) - prefix.size()));
}

Json recordings_of(const fs::path& folder, const fs::path& kept) {
  Json list = Json::array();
  std::error_code problem;
  for (fs::directory_iterator at(kept, problem), end; !problem && at != end; at.increment(problem)) {
    const auto row = row_of(at->path().filename().string());
    std::error_code ignored;  // it has gone meanwhile
    const auto file = at->path() / "run.mcap";
    if (row && fs::is_regular_file(file, ignored)) list.push_back({{"row", *row}, {"file", file.lexically_relative(folder).string()}});
  }
  return list;
}

std::vector<std::string> replay_words(const std::string& file, const std::string& instance) {
  auto options = base::option_words("--into", instance);
  options.emplace_back("--compare");
  return base::command_words({"replay"}, {file}, options);
}

}  // namespace

Result<Json> campaign_results(const fs::path& folder, const fs::path& file) {
  const auto csv = output_of_rtse(base::command_words({"results"}, {file.string()}, {"--csv"}));
  if (!csv) return csv.error();
  if (csv->size() > max_row_bytes)
    return Error{"campaign " + base::in_quotes(file.string()) + ": has more than 4 MiB of rows; rtse results shows them"};
  return Json{{"csv", *csv}, {"recordings", recordings_of(folder, fs::path(file).replace_extension(".runs"))}};
}

Result<Json> replay_component(const std::string& file, const std::string& instance) {
  const auto said = output_of_rtse(replay_words(file, instance));
  if (!said) return said.error();
  return Json{{"text", *said}};
}

std::string replay_line(const std::string& file, const std::string& instance) {
  auto words = replay_words(file, instance);
  words.insert(words.begin(), "rtse");
  return base::shell_line(words);
}

}  // namespace studio
