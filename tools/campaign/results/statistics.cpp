#include "campaign/results/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace campaign {

PassRate wilson(std::size_t passed, std::size_t all) {
  if (all == 0) return {};
  constexpr double z = 1.959963984540054;  // 97.5 % of a standard normal variable are below
  const auto n = static_cast<double>(all);
  const double p = static_cast<double>(passed) / n;
  const double middle = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return {p, std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

Summary summary(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const auto n = static_cast<double>(values.size());
  Summary result{values.size(), values.front(), values.back()};
  result.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  result.deviation = values.size() > 1 ? std::sqrt(squares / (n - 1)) : 0;
  const auto half = values.size() / 2;
  result.median = values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
  return result;
}

}  // namespace campaign
