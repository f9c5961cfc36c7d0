// Owns a file descriptor and closes it; -1: none. One thread at a time.
#pragma once

#include <unistd.h>

#include <utility>

namespace base {

class FileHandle {
 public:
  explicit FileHandle(int file = -1) : file_(file) {}
  FileHandle(FileHandle&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  FileHandle& operator=(FileHandle&& other) noexcept {
    std::swap(file_, other.file_);
    return *this;
  }
  ~FileHandle() {
    if (file_ >= 0) ::close(file_);
  }
  int get() const { return file_; }
  // The caller owns it from now on.
  int release() { return std::exchange(file_, -1); }

 private:
  int file_;
};

}  // namespace base
