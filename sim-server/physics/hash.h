// A 64-bit hash of a stream of numbers, the same on every machine for equal bits. A value; one thread at a time.
#pragma once

#include <Eigen/Geometry>
#include <bit>
#include <cstdint>
#include <string_view>

namespace sim {

class StateHash {
 public:
  void add(std::uint64_t word) {
    // One round of splitmix64 over the word and what came before.
    state_ = (state_ ^ word) + 0x9e3779b97f4a7c15U;
    state_ = (state_ ^ (state_ >> 30)) * 0xbf58476d1ce4e5b9U;
    state_ = (state_ ^ (state_ >> 27)) * 0x94d049bb133111ebU;
    state_ ^= state_ >> 31;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Eigen::Vector3d& v) { add(v.x()), add(v.y()), add(v.z()); }
  void add(const Eigen::Quaterniond& q) { add(q.w()), add(q.x()), add(q.y()), add(q.z()); }
  void add(std::string_view text) {
    for (const char c : text) add(std::uint64_t{static_cast<unsigned char>(c)});
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace sim
