#include "base/random.h"

#include <algorithm>
#include <cmath>

namespace base {

Random::Random(std::uint64_t seed, std::string_view name) : state_(seed) {
  for (const char c : name) {
    state_ ^= static_cast<unsigned char>(c);
    state_ = next();
  }
}

std::uint64_t Random::next() { return mix64(state_ += mix64_step); }

double Random::uniform() { return unit_interval(next()); }

std::uint64_t Random::below(std::uint64_t count) { return count > 0 ? next() % count : 0; }

double normal_quantile(double p) {
  const double wanted = std::clamp(p, 1e-15, 1 - 1e-15);
  double low = -9, high = 9;
  for (int i = 0; i < 80; ++i) {
    const double middle = (low + high) / 2;
    (std::erfc(-middle / std::sqrt(2.0)) / 2 < wanted ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace base
