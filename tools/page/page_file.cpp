#include "page/page_file.h"

#include <fcntl.h>
#include <libdeflate.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "base/base64.h"
#include "base/text.h"
#include "base/whole_file.h"

namespace page {
namespace {

using base::Error;
using base::Result;

constexpr int compression_level = 9;
constexpr unsigned mode_of_files = 0666;  // less the umask

std::string packed(std::string_view bytes) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(libdeflate_alloc_compressor(compression_level),
                                                                                            libdeflate_free_compressor);
  std::string result(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  result.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), result.data(), result.size()));
  return result;
}

}  // namespace

PageFile::~PageFile() {
  std::error_code ignored;
  if (!part_path_.empty()) std::filesystem::remove(part_path_, ignored);
}

Result<void> PageFile::fail(int error) const { return Error{path_ + ": " + std::generic_category().message(error)}; }

Result<void> PageFile::open() {
  auto place = base::replaceable_file(path_);
  if (!place) return Error{path_ + ": " + place.error().message};
  target_ = place->string();
  const auto folder = place->parent_path();
  int file = ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, mode_of_files);
  if (file < 0) {
    part_path_ = target_ + "." + std::to_string(::getpid()) + ".part";
    file = ::open(part_path_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, mode_of_files);
  }
  if (file < 0) return fail(errno);
  out_.reset(::fdopen(file, "wb"));
  return out_ ? Result<void>() : fail(errno);
}

void PageFile::put(std::string_view text) {
  (void)std::fwrite(text.data(), 1, text.size(), out_.get());
  size_ += text.size();
}

bool PageFile::put_data(std::initializer_list<Block> blocks) {
  std::string text;
  for (const auto& [id, bytes] : blocks)
    text += "<script type=\"text/plain\" id=\"run-" + id + "\">" + base::to_base64(packed(bytes)) + "</script>\n";
  if (size_ + text.size() + reserved_ > limit_) return false;
  put(text);
  return true;
}

Result<void> PageFile::cut(std::uint64_t size) {
  const auto end = static_cast<off_t>(size);
  if (std::fflush(out_.get()) != 0 || ::ftruncate(::fileno(out_.get()), end) != 0 || ::fseeko(out_.get(), end, SEEK_SET) != 0)
    return fail(errno);
  size_ = size;
  return {};
}

Result<void> PageFile::finish() {
  if (std::fflush(out_.get()) != 0 || std::ferror(out_.get()) != 0) return fail(errno != 0 ? errno : EIO);
  if (part_path_.empty()) {
    part_path_ = target_ + "." + std::to_string(::getpid()) + ".part";
    const auto there = "/proc/self/fd/" + std::to_string(::fileno(out_.get()));
    if (::linkat(AT_FDCWD, there.c_str(), AT_FDCWD, part_path_.c_str(), AT_SYMLINK_FOLLOW) != 0) return fail(errno);
  }
  out_.reset();
  std::error_code problem;
  std::filesystem::rename(part_path_, target_, problem);
  if (problem) return Error{path_ + ": " + problem.message()};
  part_path_.clear();
  return {};
}

}  // namespace page
