// Reads messages of ROS 2 from bytes of the network: plain CDR of either byte order behind a head of four bytes. Every length is compared
// with the bytes that are left before memory is allocated; surplus bytes at the end are ignored. Pure; any thread.
//
// Spans of bytes point into the bytes that are read. Spans of numbers point into memory of the decoder.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "ros/cdr.h"

namespace ros {

// A visitor of fields().
class Decoder {
 public:
  // `bytes` with the head; they must outlive the decoder.
  explicit Decoder(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < head_size || bytes[0] != 0 || bytes[1] > 1) {
      is_good_ = false;
      return;
    }
    is_swapped_ = bytes[1] == 0;
    body_ = bytes.subspan(head_size);
  }

  // False after the first value that did not fit.
  bool is_good() const { return is_good_; }
  template <Message T>
  bool read(T& message) {
    take(message);
    return is_good_;
  }

  template <class T>
  void operator()(std::string_view, T& value) {
    take(value);
  }

 private:
  static constexpr std::size_t head_size = little_endian_head.size();

  std::size_t left() const { return body_.size() - at_; }
  bool align(std::size_t size) {
    const std::size_t rest = at_ & (size - 1);  // sizes are powers of two
    if (rest != 0) at_ = std::min(at_ + size - rest, body_.size());
    return is_good_ = is_good_ && left() >= size;
  }
  template <Number T>
  void take(T& value) {
    if (!align(sizeof value)) return;
    std::array<std::uint8_t, sizeof(T)> raw{};
    std::memcpy(raw.data(), body_.data() + at_, sizeof value);
    at_ += sizeof value;
    if (is_swapped_) std::ranges::reverse(raw);
    if constexpr (std::is_same_v<T, bool>) {
      value = raw[0] != 0;
    } else {
      value = std::bit_cast<T>(raw);
    }
  }
  void take(std::string& text) {
    std::uint32_t size = 0;
    take(size);
    if (!is_good_ || size > left()) {
      is_good_ = false;
      return;
    }
    const auto* begin = reinterpret_cast<const char*>(body_.data() + at_);
    text.assign(begin, size == 0 || begin[size - 1] != '\0' ? size : size - 1);
    at_ += size;
  }
  template <Message T>
  void take(T& message) {
    if (is_good_) T::fields(message, *this);
  }
  template <class T>
  void take(std::vector<T>& values) {
    std::uint32_t count = 0;
    take(count);
    // No element has less than a byte.
    if (!is_good_ || count > left()) {
      is_good_ = false;
      return;
    }
    values.clear();
    values.reserve(std::min<std::size_t>(count, left() / least_size<T>()));
    for (std::uint32_t i = 0; i < count && is_good_; ++i) take(values.emplace_back());
  }
  void take(std::vector<bool>& values) {
    std::uint32_t count = 0;
    take(count);
    if (!is_good_ || count > left()) {
      is_good_ = false;
      return;
    }
    values.assign(count, false);
    for (std::uint32_t i = 0; i < count; ++i) values[i] = body_[at_ + i] != 0;
    at_ += count;
  }
  template <Number T>
  void take(std::span<const T>& values) {
    std::uint32_t count = 0;
    take(count);
    values = {};
    if (!is_good_ || count == 0) return;
    if (!align(sizeof(T)) || count > left() / sizeof(T)) {
      is_good_ = false;
      return;
    }
    if constexpr (sizeof(T) == 1) {
      values = {reinterpret_cast<const T*>(body_.data() + at_), count};
    } else {
      const auto copy = std::make_shared<std::vector<T>>(count);
      std::memcpy(copy->data(), body_.data() + at_, count * sizeof(T));
      if (is_swapped_) {
        for (T& value : *copy) std::ranges::reverse(std::span(reinterpret_cast<std::uint8_t*>(&value), sizeof value));
      }
      values = *copy;
      kept_.push_back(copy);
    }
    at_ += count * sizeof(T);
  }
  template <class T, std::size_t size>
  void take(std::array<T, size>& values) {
    for (T& value : values) take(value);
  }
  template <class T>
  static constexpr std::size_t least_size() {
    return std::max<std::size_t>(std::is_arithmetic_v<T> ? sizeof(T) : 4, 1);
  }

  std::span<const std::uint8_t> body_;
  std::size_t at_ = 0;
  bool is_swapped_ = false;
  bool is_good_ = true;
  std::vector<std::shared_ptr<void>> kept_;  // what spans of numbers point into
};

// Nothing when the bytes are no such message. Not for messages with spans of numbers, which end with the decoder.
template <Message T>
std::optional<T> decode(std::span<const std::uint8_t> bytes) {
  Decoder decoder(bytes);
  T message{};
  if (!decoder.read(message)) return std::nullopt;
  return message;
}

}  // namespace ros
