#include "reader/arrays.h"

#include <unistd.h>

#include <cerrno>

namespace sim {
namespace {

constexpr std::size_t max_buffered = std::size_t{1} << 16;
constexpr std::size_t padded(std::size_t size) { return (size + 7) / 8 * 8; }

}  // namespace

void ArrayWriter::append(const void* data, std::size_t size) {
  size_ += padded(size);
  if (file_ >= 0 && size >= max_buffered) {
    is_good_ = is_good_ && write(buffer_.data(), buffer_.size()) && write(static_cast<const char*>(data), size);
    buffer_.assign(padded(size) - size, '\0');
    return;
  }
  if (size > 0) buffer_.append(static_cast<const char*>(data), size);
  buffer_.append(padded(size) - size, '\0');
  if (file_ < 0 || buffer_.size() < max_buffered) return;
  is_good_ = is_good_ && write(buffer_.data(), buffer_.size());
  buffer_.clear();
}

bool ArrayWriter::write(const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t count = ::write(file_, data, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    data += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

bool ArrayWriter::finish() {
  if (file_ < 0) return is_good_;
  is_good_ = is_good_ && write(buffer_.data(), buffer_.size());
  buffer_.clear();
  return is_good_;
}

const std::byte* ArrayReader::take(std::uint64_t count, std::size_t each) {
  const std::size_t left = bytes_.size() - at_;
  if (!is_good_ || (count > 0 && count > left / each)) {
    is_good_ = false;
    return nullptr;
  }
  const std::byte* from = bytes_.data() + at_;
  const std::size_t size = padded(static_cast<std::size_t>(count) * each);
  if (size > left) {
    is_good_ = false;
    return nullptr;
  }
  at_ += size;
  return from;
}

}  // namespace sim
