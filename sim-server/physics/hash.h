// What the state of something is, as a row of numbers, and its 64-bit hash, the same on every machine for equal bits. A value; one thread
// at a time.
#pragma once

#include <Eigen/Geometry>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace sim {

class StateHash {
 public:
  void add(std::uint64_t word) { words_.push_back(word); }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Eigen::Vector3d& v) { add(v.x()), add(v.y()), add(v.z()); }
  void add(const Eigen::Quaterniond& q) { add(q.w()), add(q.x()), add(q.y()), add(q.z()); }
  void add(std::string_view text) {
    const auto* octets = reinterpret_cast<const unsigned char*>(text.data());
    words_.insert(words_.end(), octets, octets + text.size());
  }
  // For the next one, in the room of this one.
  void clear() { words_.clear(); }

  // All that was added, since clear().
  std::span<const std::uint64_t> words() const { return words_; }
  // Each word after the one before: four times as slow as a hash that takes several words at once, and the one that people have written
  // down.
  std::uint64_t value() const {
    std::uint64_t state = 0;
    for (const std::uint64_t word : words_) {
      // One round of splitmix64 over the word and what came before.
      state = (state ^ word) + 0x9e3779b97f4a7c15U;
      state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9U;
      state = (state ^ (state >> 27)) * 0x94d049bb133111ebU;
      state ^= state >> 31;
    }
    return state;
  }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace sim
