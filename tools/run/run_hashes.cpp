#include "run/run_hashes.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "base/hash_log.h"

namespace tools {

std::string hash_text(std::uint64_t hash) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
  return text.data();
}

RunHashes::RunHashes(const std::string& file, const Workplace& place)
    : file_(file.empty() ? "" : std::filesystem::absolute(file).string()), folder_(place.scratch("hashes")) {
  if (is_wanted()) std::filesystem::create_directories(folder_);
}

base::Result<std::uint64_t> RunHashes::merge() const {
  std::vector<std::string> parts;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) parts.push_back(entry.path().string());
  std::ranges::sort(parts);
  if (const auto merged = base::merge_hash_logs(parts, file_); !merged) return merged.error();
  auto log = base::HashLogReader::open(file_);
  if (!log) return log.error();
  for (base::HashTick tick;;) {
    const auto is_there = log->next(tick);
    if (!is_there) return is_there.error();
    if (!*is_there) return log->hash();
  }
}

}  // namespace tools
