#include "run/run_page.h"

#include <unistd.h>

#include <filesystem>

#include "base/child_process.h"
#include "base/text.h"
#include "base/whole_file.h"

namespace editor {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::chrono::minutes longest_writing{30};
constexpr std::string_view program_name = "rtse-page: ";

Error about(const std::string& page, const std::string& what) { return {"page " + base::in_quotes(page) + ": " + what}; }

// A failure: its text, and if they are known its time and object.
Json failure(const std::string& text, const std::optional<double>& time, const std::string& subject) {
  Json json{{"text", text}};
  if (time) json["time"] = *time;
  if (!subject.empty()) json["subject"] = subject;
  return json;
}

}  // namespace

Json page_summary(const RunResult& result, const std::string& command) {
  Json summary{{"passed", result.is_passed()}, {"why", Json::array()},      {"failures", Json::array()}, {"marks", Json::array()},
               {"seed", result.seed},          {"hash", result.state_hash}, {"command", command},        {"simulated", result.simulated_s}};
  const auto add = [&](const std::string& text, const std::optional<double>& time, const std::string& subject) {
    summary["why"].push_back(text);
    summary["failures"].push_back(failure(text, time, subject));
  };
  if (!result.problem.empty()) add(result.problem, result.simulated_s, "");
  for (const auto& verdict : result.verdicts) {
    if (!verdict.problem.empty()) add(failure_text(verdict), verdict.time, verdict.subject);
  }
  for (const auto& mark : result.marks) {
    if (mark.time <= result.simulated_s)
      summary["marks"].push_back({{"time", mark.time}, {"kind", mark.kind}, {"text", mark.text}, {"subject", mark.subject}});
  }
  return summary;
}

Result<std::string> write_run_page(const PageCall& call, const Json& summary) {
  const std::string file = call.file + "." + std::to_string(::getpid()) + ".json";
  const auto written = base::write_whole_file(file, summary.dump(-1, ' ', false, Json::error_handler_t::replace));
  if (!written) return written.error();
  std::vector<std::string> words{own_program("rtse-page"), call.recording, "--output", call.file, "--summary", file};
  words.insert(words.end(), {"--page-camera-rate", base::format_number(call.camera_rate)});
  words.insert(words.end(), {"--page-limit", base::format_number(call.limit_mib)});
  if (!call.other.empty()) words.insert(words.end(), {"--other", call.other});
  auto child = ChildProcess::start({.words = words, .environment = {}});
  const bool is_done = child && child->wait_or_interrupt(longest_writing) == Ending::ended && child->exit_code() == 0;
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  if (!child) return about(call.file, child.error().message);
  if (is_done) return child->said();
  const auto said = base::split_list(child->said(), '\n');
  if (said.empty()) return about(call.file, "rtse-page " + child->how_it_ended());
  return about(call.file, said.back().substr(said.back().starts_with(program_name) ? program_name.size() : 0));
}

}  // namespace editor
