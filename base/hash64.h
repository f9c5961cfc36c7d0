// A 64-bit hash of a stream of bytes, equal on every machine and for any division of the stream into pieces. It finds differences; it is
// not cryptographic. A value; one thread at a time.
//
// Eight words at a time go into four states, because each state has to wait for the product before; a product takes in two of them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace base {

class Hash64 {
 public:
  Hash64() = default;
  // Another hash for each number: who does not know it cannot make two streams of one hash on purpose.
  explicit Hash64(std::uint64_t seed) {
    for (std::uint64_t& state : states_) state = seed = mixed(state, seed);
  }
  void add(std::span<const std::byte> octets) {
    if (octets.empty()) return;
    const std::size_t filled = length_ % block_size;
    length_ += octets.size();
    if (filled != 0) {
      const std::size_t room = block_size - filled;
      if (octets.size() < room) return keep(filled, octets);
      keep(filled, octets.first(room));
      mix_blocks({rest_.data(), block_size});
      octets = octets.subspan(room);
    }
    const std::size_t whole = octets.size() - octets.size() % block_size;
    mix_blocks(octets.first(whole));
    keep(0, octets.subspan(whole));
  }
  void add(std::string_view text) { add(std::as_bytes(std::span(text))); }
  void add(std::uint64_t number) {
    number = little(number);
    add(std::as_bytes(std::span(&number, 1)));
  }
  std::uint64_t value() const {
    std::uint64_t all = length_;
    for (const std::uint64_t state : states_) all = mixed(all, state);
    const std::size_t filled = length_ % block_size;
    for (std::size_t at = 0; at < filled; at += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, rest_.data() + at, std::min(sizeof word, filled - at));
      all = mixed(all, little(word));
    }
    return all;
  }

 private:
  static constexpr std::size_t lanes = 4, block_size = 2 * lanes * sizeof(std::uint64_t);
  // Odd, with about as many ones as zeros: one for each lane.
  static constexpr std::array<std::uint64_t, lanes> factors{0x9e3779b97f4a7c15U, 0xd6e8feb86659fd93U, 0xbf58476d1ce4e5b9U,
                                                            0x94d049bb133111ebU};

  static std::uint64_t little(std::uint64_t word) {
    if constexpr (std::endian::native == std::endian::big) return __builtin_bswap64(word);
    return word;
  }
  // Both halves of a product.
  static std::uint64_t folded(std::uint64_t a, std::uint64_t b) {
    __extension__ using Wide = unsigned __int128;
    const Wide product = static_cast<Wide>(a) * b;
    return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64U);
  }
  static std::uint64_t mixed(std::uint64_t state, std::uint64_t word) {
    state = folded((state ^ word) + factors[0], factors[1]);
    return state ^ state >> 29U;
  }
  static std::uint64_t word_at(const std::byte* octets) {
    std::uint64_t word = 0;
    std::memcpy(&word, octets, sizeof word);
    return little(word);
  }
  // A state takes part in each product as one of its factors, with the second word; the first word makes the other.
  static std::uint64_t mixed(std::uint64_t state, const std::byte* octets, std::uint64_t factor) {
    return folded(word_at(octets) ^ factor, word_at(octets + sizeof factor) ^ state);
  }
  // The states are kept in registers: twice as fast.
  void mix_blocks(std::span<const std::byte> blocks) {
    auto [a, b, c, d] = states_;
    for (const std::byte *at = blocks.data(), *end = at + blocks.size(); at != end; at += block_size) {
      a = mixed(a, at, factors[0]);
      b = mixed(b, at + 16, factors[1]);
      c = mixed(c, at + 32, factors[2]);
      d = mixed(d, at + 48, factors[3]);
    }
    states_ = {a, b, c, d};
  }
  void keep(std::size_t at, std::span<const std::byte> octets) {
    if (!octets.empty()) std::memcpy(rest_.data() + at, octets.data(), octets.size());
  }

  // Numbers that nobody uses: a word that is equal to its state makes the product zero, and the other word is not seen.
  std::array<std::uint64_t, lanes> states_{0x243f6a8885a308d3U, 0x13198a2e03707345U, 0xa4093822299f31d1U, 0x082efa98ec4e6c89U};
  std::array<std::byte, block_size> rest_{};  // the octets after the last whole block
  std::uint64_t length_ = 0;
};

}  // namespace base
