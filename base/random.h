// Pseudo-random numbers that are equal on every machine, unlike the distributions of the standard library. Random: a value, one thread at a
// time. The functions: any thread.
#pragma once

#include <cstdint>
#include <string_view>

namespace base {

// The output function of SplitMix64: every bit of the result depends on every bit of `z`.
constexpr std::uint64_t mix64(std::uint64_t z) {
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

// What SplitMix64 adds to its counter at each step.
inline constexpr std::uint64_t mix64_step = 0x9e3779b97f4a7c15ULL;

// From 0 up to, not including, 1.
constexpr double unit_interval(std::uint64_t bits) { return static_cast<double>(bits >> 11U) * 0x1.0p-53; }

// SplitMix64. Streams with different seeds are independent.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  // One independent stream for each name.
  Random(std::uint64_t seed, std::string_view name);

  std::uint64_t next();
  double uniform();                          // from 0 up to, not including, 1
  std::uint64_t below(std::uint64_t count);  // 0 to count - 1

 private:
  std::uint64_t state_;
};

// The value below which a standard normal variable is with probability p, 0 < p < 1.
double normal_quantile(double p);

}  // namespace base
