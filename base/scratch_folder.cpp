#include "base/scratch_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/guarded.h"
#include "base/text.h"

namespace base {
namespace {

namespace fs = std::filesystem;

constexpr const char* lock_name = "/lock";

void remove_stale(const fs::path& where, const std::string& prefix) {
  std::error_code error;  // others clean up at the same time
  for (const auto& entry : fs::directory_iterator(where, error)) {
    if (!entry.path().filename().string().starts_with(prefix)) continue;
    struct stat status {};
    if (::lstat(entry.path().c_str(), &status) != 0 || status.st_uid != ::geteuid() || !S_ISDIR(status.st_mode)) continue;
    const int lock = ::open((entry.path().string() + lock_name).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    // Its owner could open no file, or is just about to.
    constexpr std::time_t while_made = 60;  // [s]
    if (lock < 0 && errno == ENOENT && status.st_mtime + while_made < std::time(nullptr)) ::rmdir(entry.path().c_str());
    if (lock < 0) continue;
    if (::flock(lock, LOCK_EX | LOCK_NB) == 0) fs::remove_all(entry.path(), error);
    ::close(lock);
  }
}

// False: another process took the new folder for a stale one.
bool is_there(int lock) {
  struct stat opened {};
  return ::flock(lock, LOCK_EX | LOCK_NB) == 0 && ::fstat(lock, &opened) == 0 && opened.st_nlink > 0;
}

}  // namespace

Result<ScratchFolder> ScratchFolder::make(const std::string& prefix, const std::string& where) {
  expect_no_data_held();
  std::error_code error;
  const fs::path place = where.empty() ? fs::temp_directory_path(error) : fs::path(where);
  if (error) return Error{"folder for temporary files ($TMPDIR): " + error.message()};
  remove_stale(place, prefix);
  constexpr int attempts = 5;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    auto path = (place / (prefix + "XXXXXX")).string();
    if (::mkdtemp(path.data()) == nullptr) break;
    const int lock = ::open((path + lock_name).c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    if (lock >= 0 && is_there(lock)) return ScratchFolder(std::move(path), lock);
    const int problem = errno;
    if (lock >= 0) ::close(lock);
    if (lock < 0) ::rmdir(path.c_str());
    errno = problem;
  }
  return Error{"folder " + in_quotes(place.string()) + ": no folder for temporary files can be made in it: " + std::strerror(errno)};
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;  // what stays is removed by the next process
  if (!path_.empty()) fs::remove_all(path_, ignored);
  give_away();
}

ScratchFolder::ScratchFolder(ScratchFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), lock_(std::exchange(other.lock_, -1)) {}

ScratchFolder& ScratchFolder::operator=(ScratchFolder&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(lock_, other.lock_);
  return *this;
}

void ScratchFolder::give_away() {
  path_.clear();
  if (lock_ >= 0) ::close(std::exchange(lock_, -1));
}

}  // namespace base
