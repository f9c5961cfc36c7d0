// XDR as Player uses it: every scalar fills a multiple of four bytes, big endian; texts and bytes are padded to four. Values; any thread.
#pragma once

#include <concepts>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace player {

// Appends to a text of bytes.
class XdrWriter {
 public:
  void u32(std::uint32_t value);
  void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
  void f32(float value);
  void f64(double value);
  void boolean(bool value) { u32(value ? 1 : 0); }
  // Padded with zeros, no length.
  void raw(std::string_view bytes);
  // The number of what follows, as Player counts: once as the member X_count, once more as the length of the array.
  void count(std::size_t number);
  void counted_bytes(std::string_view bytes) {
    count(bytes.size());
    raw(bytes);
  }
  // A C text: its final zero is counted and sent.
  void counted_text(std::string_view text);

  std::string& bytes() { return bytes_; }

 private:
  std::string bytes_;
};

// Reads what a peer has sent. After anything that does not fit, good() is false and all further values are 0 or empty.
class XdrReader {
 public:
  explicit XdrReader(std::string_view bytes) : rest_(bytes) {}

  std::uint32_t u32();
  std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  float f32();
  double f64();
  // A byte or short in its cell of four bytes; values above `max` do not fit.
  std::uint32_t small(std::uint32_t max);
  bool boolean() { return small(255) != 0; }
  // Both counts must agree and so many elements of `element_size` bytes must be there, at most `max`.
  std::size_t count(std::size_t element_size, std::size_t max);
  std::string_view counted_bytes(std::size_t max);
  // The bytes before the first zero, if there is one.
  std::string_view counted_text(std::size_t max);

  bool good() const { return is_good_; }
  // Everything was there and nothing is left.
  bool is_complete() const { return is_good_ && rest_.empty(); }

 private:
  std::string_view take(std::size_t size);
  std::string_view rest_;
  bool is_good_ = true;
};

}  // namespace player
