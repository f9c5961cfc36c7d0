// A file with writes at its end and reads anywhere. Errors name the path. One thread at a time.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "base/result.h"

namespace mcap {

class File final {
 public:
  // A file that is there becomes empty, unless another process writes it.
  static base::Result<File> create(const std::string& path);
  // Whether a recording may have this name: nothing is there, or a regular file.
  static base::Result<void> check_name(const std::string& path);
  // Whether somebody has it from create() at this moment, and lives.
  static bool is_being_written(const std::string& path);
  static base::Result<File> open(const std::string& path);
  File(File&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)), path_(std::move(other.path_)) {}
  File& operator=(File&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(path_, other.path_);
    return *this;
  }
  ~File();

  const std::string& path() const { return path_; }
  base::Result<std::uint64_t> size() const;
  // All of them, one behind the other.
  base::Result<void> append(std::string_view first, std::string_view second = {});
  // Exactly `size` octets, which must be there.
  base::Result<void> read(std::uint64_t offset, std::uint64_t size, std::string& out) const;
  void cut(std::uint64_t size);

 private:
  File(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}
  base::Error failed(const char* what) const;

  int descriptor_ = -1;
  std::string path_;
};

}  // namespace mcap
