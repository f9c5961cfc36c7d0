#include "campaign/results/disk_room.h"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "base/text.h"

namespace campaign {
namespace fs = std::filesystem;

base::Result<void> check_room(const std::vector<std::string>& folders, std::uintmax_t least) {
  for (const auto& folder : folders) {
    std::error_code error;
    const auto space = fs::space(folder.empty() ? "." : folder, error);
    if (error) return base::Error{"folder " + base::in_quotes(folder) + ": " + error.message()};
    if (space.available < least)
      return base::Error{"folder " + base::in_quotes(folder) + ": the disk has less than " + std::to_string(least >> 20U) + " MiB left"};
  }
  return {};
}

base::Result<void> check_writable(const std::string& folder) {
  auto name = (fs::path(folder) / "rtse-tried-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) {
    const std::error_code error(errno, std::generic_category());
    return base::Error{"folder " + base::in_quotes(folder) + ": " + error.message()};
  }
  std::error_code ignored;
  fs::remove(name, ignored);
  return {};
}

std::string temporary_folder() {
  const char* named = std::getenv("TMPDIR");
  return named != nullptr && *named != '\0' ? named : "/tmp";
}

}  // namespace campaign
