// Statistics of measures. Any thread.
#pragma once

#include <cstddef>
#include <vector>

namespace campaign {

struct PassRate {
  double rate = 0, low = 0, high = 1;  // the last two: an interval that holds the true rate in 95 of 100 cases (Wilson)
};
PassRate wilson(std::size_t passed, std::size_t all);

struct Summary {
  std::size_t count = 0;
  double min = 0, max = 0, mean = 0, deviation = 0, median = 0;
};
Summary summary(std::vector<double> values);

}  // namespace campaign
