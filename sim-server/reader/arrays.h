// Plain numbers, arrays and texts one after the other: how a request and a result cross between sim-server and rtm-asset-reader. Each item
// starts at a multiple of 8 bytes; arrays and texts begin with their count (64 bits). Byte order and sizes are those of the machine: both
// ends are built together. One thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sim {

class ArrayWriter {
 public:
  // Without a file all stays in memory; else what is long is written to it at once.
  explicit ArrayWriter(int file = -1) : file_(file) {}

  template <class T>
  void number(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&value, sizeof(T));
  }
  template <class T>
  void array(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    number<std::uint64_t>(values.size());
    append(values.data(), values.size_bytes());
  }
  template <class T>
  void array(const std::vector<T>& values) {
    array(std::span<const T>(values));
  }
  void text(std::string_view text) { array(std::span<const char>(text)); }

  // All of it, padding included.
  std::uint64_t size() const { return size_; }
  // What is not in the file.
  const std::string& bytes() const { return buffer_; }
  // False when the file could not take all of it.
  bool finish();

 private:
  void append(const void* data, std::size_t size);
  bool write(const char* data, std::size_t size);

  int file_;
  bool is_good_ = true;
  std::uint64_t size_ = 0;
  std::string buffer_;
};

// Reads what may be anything: after the first item that does not fit, every further one is empty and ok() is false.
class ArrayReader {
 public:
  explicit ArrayReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool ok() const { return is_good_; }
  // For checks of the content.
  void refuse() { is_good_ = false; }

  template <class T>
  T number() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value{};
    if (const std::byte* from = take(1, sizeof(T))) std::memcpy(&value, from, sizeof(T));
    return value;
  }
  template <class T>
  std::vector<T> array(std::uint64_t most) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values;
    const auto count = number<std::uint64_t>();
    if (count > most) is_good_ = false;
    const std::byte* from = take(count, sizeof(T));
    if (from == nullptr) return values;
    values.resize(static_cast<std::size_t>(count));
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), from, values.size() * sizeof(T));
    return values;
  }
  std::string text(std::uint64_t most) {
    const auto characters = array<char>(most);
    return {characters.begin(), characters.end()};
  }
  // A count of further items, each of at least 8 bytes.
  std::uint64_t count(std::uint64_t most) {
    const auto count = number<std::uint64_t>();
    if (count > most || count > bytes_.size() / 8) is_good_ = false;
    return is_good_ ? count : 0;
  }

 private:
  // Null when there is not as much.
  const std::byte* take(std::uint64_t count, std::size_t each);

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool is_good_ = true;
};

}  // namespace sim
