// Points of the unit cube: random ones, Latin hypercubes, Sobol's sequence. Any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "base/result.h"
#include "campaign/plan/plan.h"

namespace campaign {

inline constexpr std::size_t max_sobol_dimensions = 16;

// `count` points with `dimensions` coordinates from 0 up to, not including, 1. The error: Sobol's sequence has 16 dimensions here.
Result<std::vector<std::vector<double>>> unit_samples(Plan::Sampling sampling, std::size_t count, std::size_t dimensions,
                                                      std::uint64_t seed);

// Where a coordinate lies in a range.
double in_range(const Range& range, double coordinate);

}  // namespace campaign
