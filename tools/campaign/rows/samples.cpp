#include "campaign/rows/samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/random.h"

namespace campaign {
namespace {

using Points = std::vector<std::vector<double>>;

Points random_points(std::size_t count, std::size_t dimensions, base::Random& random) {
  Points points(count, std::vector<double>(dimensions));
  for (auto& point : points) {
    for (auto& coordinate : point) coordinate = random.uniform();
  }
  return points;
}

// In every dimension each of `count` equal pieces has one point.
Points latin_points(std::size_t count, std::size_t dimensions, base::Random& random) {
  Points points(count, std::vector<double>(dimensions));
  std::vector<std::size_t> pieces(count);
  for (std::size_t d = 0; d < dimensions; ++d) {
    std::iota(pieces.begin(), pieces.end(), 0U);
    for (std::size_t i = count; i > 1; --i) std::swap(pieces[i - 1], pieces[random.below(i)]);
    for (std::size_t i = 0; i < count; ++i) points[i][d] = (static_cast<double>(pieces[i]) + random.uniform()) / static_cast<double>(count);
  }
  return points;
}

// A primitive polynomial over the field of two elements (degree; coefficients between the first and the last) and the first direction
// numbers, for the dimensions from the second on.
struct Direction {
  unsigned degree, coefficients;
  std::array<std::uint32_t, 6> first;
};
constexpr std::array<Direction, max_sobol_dimensions - 1> directions = {{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
}};

constexpr unsigned bits = 32;

std::array<std::uint32_t, bits> direction_numbers(std::size_t dimension) {
  std::array<std::uint32_t, bits> v{};
  if (dimension == 0) {
    for (unsigned i = 0; i < bits; ++i) v[i] = 1U << (bits - 1 - i);
    return v;
  }
  const Direction& d = directions[dimension - 1];
  for (unsigned i = 0; i < bits; ++i) {
    if (i < d.degree) {
      v[i] = d.first[i] << (bits - 1 - i);
      continue;
    }
    v[i] = v[i - d.degree] ^ (v[i - d.degree] >> d.degree);
    for (unsigned k = 1; k < d.degree; ++k) {
      if ((d.coefficients >> (d.degree - 1 - k)) & 1U) v[i] ^= v[i - k];
    }
  }
  return v;
}

// Shifted by random bits, so that another seed gives other points; their even spread stays.
Points sobol_points(std::size_t count, std::size_t dimensions, base::Random& random) {
  Points points(count, std::vector<double>(dimensions));
  for (std::size_t d = 0; d < dimensions; ++d) {
    const auto v = direction_numbers(d);
    const auto shift = static_cast<std::uint32_t>(random.next());
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t x = shift;
      const std::uint64_t gray = i ^ (i >> 1U);
      for (unsigned bit = 0; bit < bits; ++bit) {
        if ((gray >> bit) & 1U) x ^= v[bit];
      }
      points[i][d] = static_cast<double>(x) * 0x1.0p-32;
    }
  }
  return points;
}

}  // namespace

Result<Points> unit_samples(Plan::Sampling sampling, std::size_t count, std::size_t dimensions, std::uint64_t seed) {
  base::Random random(seed, "samples");
  switch (sampling) {
    case Plan::Sampling::latin:
      return latin_points(count, dimensions, random);
    case Plan::Sampling::sobol:
      if (dimensions > max_sobol_dimensions)
        return Error{"sampling sobol: at most " + std::to_string(max_sobol_dimensions) + " ranges, got " + std::to_string(dimensions) +
                     "; latin has no limit"};
      return sobol_points(count, dimensions, random);
    case Plan::Sampling::random:
      break;
  }
  return random_points(count, dimensions, random);
}

double in_range(const Range& range, double coordinate) {
  switch (range.kind) {
    case Range::Kind::normal:
      return range.a + range.b * base::normal_quantile(coordinate);
    case Range::Kind::log:
      return range.a * std::pow(range.b / range.a, coordinate);
    case Range::Kind::uniform:
      break;
  }
  return range.a + (range.b - range.a) * coordinate;
}

}  // namespace campaign
