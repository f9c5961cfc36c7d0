#include "base/plain_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <vector>

#include "base/suggestion.h"
#include "base/text.h"

#include "base/guarded.h"

namespace base {
namespace {

class OpenFile {
 public:
  explicit OpenFile(int file) : file_(file) {}
  ~OpenFile() {
    if (file_ >= 0) ::close(file_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int get() const { return file_; }

 private:
  int file_;
};

Error unreadable(int code) { return {"cannot be read: " + std::generic_category().message(code)}; }

}  // namespace

Result<std::string> read_plain_file(const std::filesystem::path& file, std::uintmax_t max_bytes, struct stat* status) {
  expect_no_data_held();
  struct stat is {};
  // Looked at before it is opened: opening alone can move a tape or wake a driver.
  if (::stat(file.c_str(), &is) != 0) {
    if (errno == ENOENT || errno == ENOTDIR) return Error{"no such file"};
    return unreadable(errno);
  }
  if (!S_ISREG(is.st_mode)) return Error{"is not a regular file"};
  const OpenFile opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (opened.get() < 0) return unreadable(errno);
  if (::fstat(opened.get(), &is) != 0) return unreadable(errno);
  if (!S_ISREG(is.st_mode)) return Error{"is not a regular file"};
  if (static_cast<std::uintmax_t>(is.st_size) > max_bytes)
    return Error{"a file of at most " + std::to_string(max_bytes >> 20U) + " MiB is expected"};
  std::string bytes(static_cast<std::size_t>(is.st_size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::read(opened.get(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return unreadable(errno);
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);  // it has become shorter meanwhile
  if (status != nullptr) *status = is;
  return bytes;
}

namespace {

// Of a file that is not there: what in its folder has nearly its name.
std::string meant_instead(const std::filesystem::path& file) {
  constexpr std::size_t max_compared = 1000;
  std::vector<std::string> names;
  std::error_code error;
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, error)) return "; there is no folder " + in_quotes(folder.string());
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end && names.size() < max_compared;
       entry.increment(error))
    names.push_back(entry->path().filename().string());
  return suggestion(file.filename().string(), names);
}

}  // namespace

std::string file_problem(const std::filesystem::path& file) {
  struct stat is {};
  if (::stat(file.c_str(), &is) != 0)
    return errno == ENOENT || errno == ENOTDIR ? "no such file" + meant_instead(file) : unreadable(errno).message;
  if (S_ISDIR(is.st_mode)) return "is a folder; a file is expected";
  return ::access(file.c_str(), R_OK) == 0 ? "" : unreadable(errno).message;
}

bool is_plain_file(const std::filesystem::path& file) {
  expect_no_data_held();
  struct stat is {};
  return ::stat(file.c_str(), &is) == 0 && S_ISREG(is.st_mode);
}

}  // namespace base
