#include "delivery_rule.h"

#include <algorithm>
#include <cmath>

namespace warehouse {
namespace {

constexpr double arrival = 0.02;         // [m] short of the end counts as there
constexpr double slowest = 0.05;         // [m/s]
constexpr double braking = 0.4;          // [m/s2]
constexpr double offset_gain = 1.2;      // [rad/s per m]
constexpr double heading_gain = 2.0;     // [1/s]
constexpr double fastest_turn = 0.6;     // [rad/s]
constexpr double nearest_return = 0.15;  // [m] below it a beam hits the robot itself, or nothing that can be there

}  // namespace

Stage next_stage(Stage stage, const Place& place, double time, const Settings& settings) {
  if (stage == Stage::waiting && time >= settings.start_time) return Stage::bringing;
  if (stage == Stage::bringing && place.x >= settings.distance - arrival) return Stage::returning;
  if (stage == Stage::returning && place.x <= arrival) return Stage::done;
  return stage;
}

Velocity drive(Stage stage, const Place& place, const Settings& settings) {
  if (stage != Stage::bringing && stage != Stage::returning) return {};
  const bool goes_on = stage == Stage::bringing;
  const double left = std::max(goes_on ? settings.distance - place.x : place.x, 0.0);
  const double speed = std::clamp(std::sqrt(2 * braking * left), slowest, std::max(settings.speed, slowest));
  const double way = goes_on ? 1 : -1;
  const double turn = -heading_gain * place.heading - way * offset_gain * place.y;
  return {way * speed, std::clamp(turn, -fastest_turn, fastest_turn)};
}

bool is_blocked(std::span<const double> ranges, double first_angle, double step, const Settings& settings) {
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (ranges[i] < nearest_return) continue;
    const double angle = first_angle + static_cast<double>(i) * step;
    const double ahead = ranges[i] * std::cos(angle), aside = ranges[i] * std::sin(angle);
    if (ahead > 0 && ahead < settings.stop_distance && std::abs(aside) < settings.lane_width / 2) return true;
  }
  return false;
}

}  // namespace warehouse
