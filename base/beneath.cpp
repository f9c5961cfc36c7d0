#include "base/beneath.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/guarded.h"
#include "base/text.h"

namespace base {
namespace {

namespace fs = std::filesystem;

class OpenAt {
 public:
  explicit OpenAt(int number) : number_(number) {}
  OpenAt(OpenAt&& other) noexcept : number_(other.number_) { other.number_ = -1; }
  OpenAt& operator=(OpenAt&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~OpenAt() {
    if (number_ >= 0) ::close(number_);
  }
  int get() const { return number_; }

 private:
  int number_;
};

bool stays_below(const fs::path& relative) {
  if (relative.empty() || relative.is_absolute() || relative.string().find('\0') != std::string::npos) return false;
  for (const auto& part : relative) {
    if (part.empty() || part == "..") return false;
  }
  return true;
}

}  // namespace

// Each part is opened from the one before, so that what is checked is what is read. openat2 would do the same, where it is allowed.
Result<std::string> read_beneath(const fs::path& folder, const fs::path& relative, std::size_t most) {
  expect_no_data_held();
  const auto bad = [&](const std::string& what) { return Error{"file " + in_quotes((folder / relative).string()) + ": " + what}; };
  if (!stays_below(relative)) return bad("is not below " + in_quotes(folder.string()));
  OpenAt at(::open(folder.empty() ? "." : folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (at.get() < 0) return bad(std::strerror(errno));
  for (const auto& part : relative.parent_path()) {
    at = OpenAt(::openat(at.get(), part.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
    if (at.get() < 0) return bad(errno == ENOTDIR || errno == ELOOP ? "a part of its path is no folder" : std::strerror(errno));
  }
  // What it is, before it is opened: to open a device may do something.
  const auto name = relative.filename();
  const auto is_regular = [](const struct stat& status) { return S_ISREG(status.st_mode); };
  struct stat status {};
  if (::fstatat(at.get(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) return bad(std::strerror(errno));
  if (!is_regular(status)) return bad("is not a regular file");
  const OpenAt file(::openat(at.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (file.get() < 0) return bad(std::strerror(errno));
  if (::fstat(file.get(), &status) != 0 || !is_regular(status)) return bad("is not a regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > most) return bad("has " + std::to_string(size) + " bytes, expected at most " + std::to_string(most));
  std::string bytes(size, '\0');
  std::size_t got = 0;
  while (got < size) {
    const auto n = ::read(file.get(), bytes.data() + got, size - got);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return bad(std::strerror(errno));
    if (n == 0) break;  // it was cut meanwhile
    got += static_cast<std::size_t>(n);
  }
  bytes.resize(got);
  return bytes;
}

Result<void> check_regular_file(const fs::path& file, const RegularFile& wanted) {
  expect_no_data_held();
  const auto bad = [&](const std::string& what) { return Error{"file " + in_quotes(file.string()) + ": " + what}; };
  struct stat status {};
  const int failed = wanted.follows ? ::stat(file.c_str(), &status) : ::lstat(file.c_str(), &status);
  if (failed != 0 && errno == ENOENT && wanted.may_be_absent) return {};
  if (failed != 0) return bad(std::strerror(errno));
  if (!S_ISREG(status.st_mode)) return bad("is not a regular file");
  return {};
}

}  // namespace base
