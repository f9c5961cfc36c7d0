#include "system/profile/rts_profile.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "base/plain_file.h"
#include "base/text.h"
#include "base/whole_file.h"

namespace tools {
namespace {

constexpr std::uintmax_t largest_file = 64u << 20;

base::Result<std::string> content_of(const std::string& file) {
  if (file == "-") return std::string(std::istreambuf_iterator<char>(std::cin), {});
  std::error_code error;
  if (const auto problem = base::file_problem(file); !problem.empty()) return base::Error{"file " + base::in_quotes(file) + ": " + problem};
  if (!base::is_plain_file(file)) return base::Error{"file " + base::in_quotes(file) + ": is not a regular file"};
  if (std::filesystem::file_size(file, error) > largest_file)
    return base::Error{"file " + base::in_quotes(file) + ": is larger than 64 MiB"};
  std::ifstream in(file, std::ios::binary);
  if (!in) return base::Error{"file " + base::in_quotes(file) + ": cannot be read"};
  return std::string(std::istreambuf_iterator<char>(in), {});
}

}  // namespace

int SavedPlace::pixels(const std::string& text) {
  constexpr std::int64_t most = 1'000'000;
  return static_cast<int>(std::clamp(base::parse_integer(text).value_or(0), -most, most));
}

const SavedComponent* SavedSystem::component(const std::string& instance) const {
  for (const auto& candidate : components) {
    if (candidate.instance == instance) return &candidate;
  }
  return nullptr;
}

base::Result<SavedSystem> read_system(const std::string& file) {
  auto content = content_of(file);
  if (!content) return content.error();
  const auto start = base::trim(*content);
  if (start.empty()) return base::Error{"file " + base::in_quotes(file) + ": is empty"};
  const bool is_xml = start.front() == '<' || start.starts_with("\xef\xbb\xbf<");
  return is_xml ? parse_xml(*content, file) : parse_yaml(*content, file);
}

base::Result<void> write_system(const SavedSystem& system, const std::string& file) {
  const bool is_yaml = file.ends_with(".yaml") || file.ends_with(".yml");
  return base::write_whole_file(file, is_yaml ? to_yaml(system) : to_xml(system));
}

}  // namespace tools
