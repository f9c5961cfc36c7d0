#include "campaign/rows/random.h"

#include <algorithm>
#include <cmath>

namespace campaign {

Random::Random(std::uint64_t seed, std::string_view name) : state_(seed) {
  for (const char c : name) {
    state_ ^= static_cast<unsigned char>(c);
    state_ = next();
  }
}

std::uint64_t Random::next() {
  state_ += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

double Random::uniform() { return static_cast<double>(next() >> 11U) * 0x1.0p-53; }

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

}  // namespace campaign
