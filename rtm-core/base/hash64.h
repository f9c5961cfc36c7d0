// A 64-bit hash of a stream of octets, the same on every machine and however the stream is cut into pieces. For finding differences, not
// for keeping secrets. A value; one thread at a time.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace base {

class Hash64 {
 public:
  void add(std::span<const std::byte> octets) {
    length_ += octets.size();
    while (!octets.empty() && (filled_ != 0 || octets.size() < sizeof(std::uint64_t))) {
      word_ |= std::to_integer<std::uint64_t>(octets.front()) << (8 * filled_);
      octets = octets.subspan(1);
      if (++filled_ == sizeof word_) mix(word_), word_ = 0, filled_ = 0;
    }
    for (; octets.size() >= sizeof(std::uint64_t); octets = octets.subspan(sizeof(std::uint64_t))) {
      std::uint64_t word = 0;
      std::memcpy(&word, octets.data(), sizeof word);
      if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap64(word);
      mix(word);
    }
    if (!octets.empty()) add_tail(octets);
  }
  void add(std::string_view text) { add(std::as_bytes(std::span(text))); }
  void add(std::uint64_t number) {
    std::byte octets[sizeof number];
    for (std::size_t i = 0; i < sizeof number; ++i) octets[i] = static_cast<std::byte>(number >> (8 * i));
    add(std::span<const std::byte>(octets));
  }
  std::uint64_t value() const {
    Hash64 end = *this;
    end.mix(word_);
    end.mix(length_);
    return end.state_;
  }

 private:
  void add_tail(std::span<const std::byte> octets) {
    for (const std::byte octet : octets) word_ |= std::to_integer<std::uint64_t>(octet) << (8 * filled_++);
  }
  // Both halves of a product with an odd number.
  void mix(std::uint64_t word) {
    __extension__ using Wide = unsigned __int128;
    const Wide product = static_cast<Wide>((state_ ^ word) + 0x9e3779b97f4a7c15U) * 0xd6e8feb86659fd93U;
    state_ = static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64U);
    state_ ^= state_ >> 29U;
  }

  std::uint64_t state_ = 0, length_ = 0, word_ = 0;
  unsigned filled_ = 0;
};

}  // namespace base
