#include "base/whole_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "base/guarded.h"
#include "base/text.h"

namespace base {
namespace {

namespace fs = std::filesystem;

// Where a symbolic link leads, also when nothing is there yet.
fs::path behind_links(fs::path file) {
  constexpr int most = 40;
  std::error_code error;
  for (int i = 0; i < most && fs::is_symlink(file, error); ++i) {
    const auto next = fs::read_symlink(file, error);
    if (error) break;
    file = file.parent_path() / next;
  }
  return file;
}

// 0, or errno.
int write_all(int file, std::string_view octets) {
  while (!octets.empty()) {
    const ssize_t written = ::write(file, octets.data(), octets.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    octets.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int make_file(const fs::path& file, std::string_view octets) {
  const int handle = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (handle < 0) return errno;
  const int problem = write_all(handle, octets);
  const int closing = ::close(handle) == 0 ? 0 : errno;  // some disks tell only here that they are full
  return problem != 0 ? problem : closing;
}

}  // namespace

Result<void> write_whole_file(const fs::path& file, std::string_view octets) {
  expect_no_data_held();
  const auto bad = [&](const std::string& what) { return Error{"file " + in_quotes(file.string()) + ": " + what}; };
  std::error_code error;
  const auto status = fs::status(file, error);
  if (fs::is_directory(status)) return bad("is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) return bad("is no ordinary file");
  const fs::path target = behind_links(file);
  const fs::path part = target.string() + ".part" + std::to_string(::getpid());
  int problem = make_file(part, octets);
  if (problem == 0 && ::rename(part.c_str(), target.c_str()) != 0) problem = errno;
  if (problem == 0) return {};
  ::unlink(part.c_str());
  return bad(std::string("cannot be written: ") + std::strerror(problem));
}

}  // namespace base
