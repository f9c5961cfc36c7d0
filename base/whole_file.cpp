#include "base/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
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

// `before`: the file that it takes the place of, which may be for its owner alone; null: there is none.
int make_file(const fs::path& file, std::string_view octets, const struct stat* before) {
  constexpr mode_t own = 0600, usual = 0666, permissions = 07777;
  const int handle = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, before != nullptr ? own : usual);
  if (handle < 0) return errno;
  int problem = 0;
  // Its owner only where that may be changed; a mode is that of the new owner then.
  if (before != nullptr) (void)!::fchown(handle, before->st_uid, before->st_gid);
  if (before != nullptr && ::fchmod(handle, before->st_mode & permissions) != 0) problem = errno;
  if (problem == 0) problem = write_all(handle, octets);
  const int closing = ::close(handle) == 0 ? 0 : errno;  // some disks tell only here that they are full
  return problem != 0 ? problem : closing;
}

}  // namespace

Result<fs::path> replaceable_file(const fs::path& file) {
  std::error_code error;
  const auto status = fs::status(file, error);
  if (fs::is_directory(status)) return Error{"is a folder"};
  if (fs::exists(status) && !fs::is_regular_file(status)) return Error{"is no ordinary file"};
  return behind_links(file);
}

Result<void> check_writable_file(const fs::path& file) {
  expect_no_data_held();
  const auto bad = [&](const std::string& what) { return Error{"file " + in_quotes(file.string()) + ": " + what}; };
  const auto place = replaceable_file(file);
  if (!place) return bad(place.error().message);
  const auto folder = place->has_parent_path() ? place->parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error)) return bad("there is no folder " + folder.string());
  // Some file systems tell only by a try.
  const bool is_there = fs::exists(*place, error);
  const fs::path tried = is_there ? *place : fs::path(place->string() + ".part" + std::to_string(::getpid()));
  const int handle = ::open(tried.c_str(), O_WRONLY | O_CLOEXEC | (is_there ? 0 : O_CREAT | O_EXCL), 0600);
  if (handle < 0) return bad(std::string("cannot be written: ") + std::strerror(errno));
  ::close(handle);
  if (!is_there) ::unlink(tried.c_str());
  return {};
}

Result<void> write_whole_file(const fs::path& file, std::string_view octets) {
  expect_no_data_held();
  const auto place = replaceable_file(file);
  const auto bad = [&](const std::string& what) { return Error{"file " + in_quotes(file.string()) + ": " + what}; };
  if (!place) return bad(place.error().message);
  const fs::path& target = *place;
  const fs::path part = target.string() + ".part" + std::to_string(::getpid());
  struct stat before {};
  const bool has_before = ::stat(target.c_str(), &before) == 0;
  int problem = make_file(part, octets, has_before ? &before : nullptr);
  if (problem == 0 && ::rename(part.c_str(), target.c_str()) != 0) problem = errno;
  if (problem == 0) return {};
  ::unlink(part.c_str());
  return bad(std::string("cannot be written: ") + std::strerror(problem));
}

}  // namespace base
