#include "steering.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace follow {

Velocity towards(const Sighting& leader, const SteeringSettings& settings) {
  Velocity velocity;
  velocity.turn = std::clamp(settings.bearing_gain * leader.bearing, -settings.max_turn, settings.max_turn);
  if (leader.distance >= settings.too_near) {
    const double wanted = settings.distance_gain * (leader.distance - settings.distance) * std::cos(leader.bearing);
    velocity.forward = std::clamp(wanted, 0.0, settings.max_speed);
  }
  return velocity;
}

std::optional<Velocity> around(const Scan& scan, const Sighting& leader, const SteeringSettings& settings) {
  constexpr double degree = std::numbers::pi / 180;
  double right = scan.max_range, left = scan.max_range;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (i >= leader.first && i <= leader.last) continue;
    double& side = i <= scan.ranges.size() / 2 ? right : left;
    side = std::min(side, static_cast<double>(scan.ranges[i]));
  }
  if (std::min(left, right) >= settings.clearance) return std::nullopt;
  // 0 at half a metre, 100 from a metre on.
  const double r = std::min(200 * right - 100, 100.0), l = std::min(200 * left - 100, 100.0);
  return Velocity{std::clamp((r + l) / 1000, 0.0, settings.max_speed), std::clamp(l - r, -40.0, 40.0) * degree};
}

}  // namespace follow
