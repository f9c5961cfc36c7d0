// Numbers that look random and are the same on every machine. Values; one thread at a time.
#pragma once

#include <cstdint>
#include <string_view>

namespace campaign {

// SplitMix64, a counter behind a mixing function: streams that start from different seeds have nothing to do with each other.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  // A stream of its own for each name.
  Random(std::uint64_t seed, std::string_view name);

  std::uint64_t next();
  double uniform();                          // from 0 up to, not including, 1
  std::uint64_t below(std::uint64_t count);  // 0 to count - 1

 private:
  std::uint64_t state_;
};

// The number below which a standard normal variable is with probability p, 0 < p < 1.
double normal_quantile(double p);

}  // namespace campaign
