// A state as a row of numbers, and its 64-bit hash, which is the same on every machine for equal bits. A value; one thread at a time.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "base/random.h"

namespace sim {

class StateHash {
 public:
  void add(std::uint64_t word) { *room(1) = word; }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Eigen::Vector3d& v) { add_all(v.x(), v.y(), v.z()); }
  void add(const Eigen::Quaterniond& q) { add_all(q.w(), q.x(), q.y(), q.z()); }
  void add(std::string_view text) {
    std::transform(text.begin(), text.end(), room(text.size()), [](char c) { return static_cast<unsigned char>(c); });
  }
  // Several with one look for room: most of what is recorded in a tick comes through here.
  template <class... Numbers>
  void add_all(Numbers... values) {
    std::uint64_t* at = room(sizeof...(values));
    ((*at++ = std::bit_cast<std::uint64_t>(values)), ...);
  }
  // For the next one, in the room of this one.
  void clear() { size_ = 0; }

  // All that was added, since clear().
  std::span<const std::uint64_t> words() const { return {words_.data(), size_}; }
  // Each word after the one before: four times as slow as a hash that takes several words at once, and the one that people have written
  // down.
  std::uint64_t value() const {
    std::uint64_t state = 0;
    for (const std::uint64_t word : words()) {
      // One round of splitmix64 over the word and what came before.
      state = base::mix64((state ^ word) + base::mix64_step);
    }
    return state;
  }

 private:
  std::uint64_t* room(std::size_t count) {
    if (size_ + count > words_.size()) words_.resize(std::max<std::size_t>({size_ + count, 2 * words_.size(), 64}));
    return words_.data() + std::exchange(size_, size_ + count);
  }

  std::vector<std::uint64_t> words_;  // the first size_ of them
  std::size_t size_ = 0;
};

}  // namespace sim
