#include "recording/mcap/file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "base/plain_file.h"
#include "base/text.h"

namespace mcap {

namespace {

base::Error cannot(const std::string& path, const char* what, int reason) {
  return {base::in_quotes(path) + ": cannot be " + what + ": " + std::strerror(reason)};
}

}  // namespace

base::Error File::failed(const char* what) const { return cannot(path_, what, errno); }

base::Result<void> File::check_name(const std::string& path) {
  struct stat there {};
  if (::stat(path.c_str(), &there) != 0 || S_ISREG(there.st_mode)) return {};
  return base::Error{base::in_quotes(path) + ": is not a regular file; expected the name of a recording to write"};
}

base::Result<File> File::create(const std::string& path) {
  if (const auto good = check_name(path); !good) return good.error();
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0644);
  if (descriptor < 0) return cannot(path, "written", errno);
  File file(descriptor, path);
  // A file system without locks has none.
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    return base::Error{base::in_quotes(path) + ": is being written by another process"};
  if (::ftruncate(descriptor, 0) != 0) return file.failed("written");
  return file;
}

bool File::is_being_written(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return false;
  const bool is_locked = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return is_locked;
}

base::Result<File> File::open(const std::string& path) {
  if (const auto problem = base::file_problem(path); !problem.empty())
    return base::Error{"recording " + base::in_quotes(path) + ": " + problem};
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return cannot(path, "read", errno);
  File file(descriptor, path);
  struct stat there {};
  if (::fstat(descriptor, &there) != 0 || !S_ISREG(there.st_mode)) {
    return base::Error{base::in_quotes(path) + ": is not a regular file; expected a recording"};
  }
  return file;
}

File::~File() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

base::Result<std::uint64_t> File::size() const {
  struct stat there {};
  if (::fstat(descriptor_, &there) != 0) return failed("read");
  return static_cast<std::uint64_t>(there.st_size);
}

base::Result<void> File::append(std::string_view first, std::string_view second) {
  while (!first.empty() || !second.empty()) {
    const std::array<iovec, 2> parts{iovec{const_cast<char*>(first.data()), first.size()},
                                     iovec{const_cast<char*>(second.data()), second.size()}};
    const ssize_t written = ::writev(descriptor_, parts.data(), static_cast<int>(parts.size()));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return failed("written");
    const std::size_t of_first = std::min(first.size(), static_cast<std::size_t>(written));
    first.remove_prefix(of_first);
    second.remove_prefix(static_cast<std::size_t>(written) - of_first);
  }
  return {};
}

base::Result<void> File::read(std::uint64_t offset, std::uint64_t size, std::string& out) const {
  out.resize(size);
  std::uint64_t done = 0;
  while (done < size) {
    const ssize_t got = ::pread(descriptor_, out.data() + done, size - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return failed("read");
    if (got == 0) return base::Error{base::in_quotes(path_) + ": ends while it is read"};
    done += static_cast<std::uint64_t>(got);
  }
  return {};
}

void File::cut(std::uint64_t size) {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) return;  // the reader finds the last whole record by itself
}

}  // namespace mcap
