#include "avoidance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace avoidance {
namespace {

double nearest(std::span<const double> ranges, double max_range) {
  double result = max_range;
  for (const double range : ranges) {
    if (std::isfinite(range) && range >= 0) result = std::min(result, range);
  }
  return result;
}

}  // namespace

Velocity avoid(std::span<const double> ranges, double max_range, const Settings& settings) {
  if (ranges.empty()) return {};
  const auto right_count = ranges.size() / 2 + 1;  // the middle beam counts to the right
  const auto value = [&](std::span<const double> side) {
    return std::min(settings.distance_gain * (nearest(side, max_range) - settings.stop_distance), settings.clearance_cap);
  };
  const double right = value(ranges.first(std::min(right_count, ranges.size())));
  const double left = value(ranges.subspan(std::min(right_count, ranges.size())));
  const double turn = std::clamp((left - right) * settings.turn_gain, -settings.max_turn, settings.max_turn);
  return {(left + right) * settings.speed_gain, turn * std::numbers::pi / 180};
}

}  // namespace avoidance
