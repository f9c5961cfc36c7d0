#include "shm/pose_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shm {
namespace {

// [1/s] so that braking from the limit needs no more than the acceleration, and the odometry is fresh enough.
double factor(double most, double limit, double acceleration, double rate) { return std::min({most, acceleration / limit, 0.3 * rate}); }

double speed_for(double distance, const DriveLimits& limits) {
  constexpr double slowest = 0.02;  // [m/s]: the last millimetres would take for ever
  return std::min(limits.speed, std::max(slowest, factor(1.5, limits.speed, limits.acceleration, limits.rate) * distance));
}

double turn_for(double error, const DriveLimits& limits) {
  return std::clamp(factor(2, limits.turn, limits.turn_acceleration, limits.rate) * error, -limits.turn, limits.turn);
}

double difference(double to, double from) { return std::remainder(to - from, 2 * std::numbers::pi); }

}  // namespace

DriveLimits within(DriveLimits wanted, const Position2dInfo& robot) {
  const auto lower = [](double value, double limit) { return limit > 0 ? std::min(value, limit) : value; };
  wanted.speed = lower(wanted.speed, robot.max_speed);
  wanted.turn = lower(wanted.turn, robot.max_yaw_rate);
  wanted.acceleration = lower(wanted.acceleration, robot.max_acceleration);
  wanted.turn_acceleration = lower(wanted.turn_acceleration, robot.max_yaw_acceleration);
  if (robot.rate > 0) wanted.rate = robot.rate;
  wanted.is_holonomic = robot.drive == RTMSIM_DRIVE_HOLONOMIC;
  return wanted;
}

double turn_towards(double heading, double wanted, const DriveLimits& limits) { return turn_for(difference(wanted, heading), limits); }

PlanarPose PoseControl::turn_to_heading(double heading_error) {
  if (std::abs(heading_error) < straight_enough) {
    phase_ = Phase::arrived;
    return {};
  }
  return {0, 0, turn_for(heading_error, limits_)};
}

PlanarPose PoseControl::next_holonomic(double ahead, double beside, double heading_error) {
  const double distance = std::hypot(ahead, beside);
  const bool is_there = distance < near_enough;
  if (is_there && std::abs(heading_error) < straight_enough) {
    phase_ = Phase::arrived;
    return {};
  }
  const double speed = is_there ? 0 : speed_for(distance, limits_) / distance;
  return {speed * ahead, speed * beside, turn_for(heading_error, limits_)};
}

PlanarPose PoseControl::next(const PlanarPose& odometry) {
  if (phase_ == Phase::arrived) return {};
  const double dx = goal_.x - odometry.x, dy = goal_.y - odometry.y, distance = std::hypot(dx, dy);
  const double c = std::cos(odometry.a), s = std::sin(odometry.a);
  const double ahead = c * dx + s * dy, beside = c * dy - s * dx;
  const double heading_error = difference(goal_.a, odometry.a);
  if (limits_.is_holonomic) return next_holonomic(ahead, beside, heading_error);

  // Where the direction of what is left says nothing any more: the robot just goes on until the goal is beside it.
  constexpr double last = 5 * near_enough;
  const bool is_last = phase_ == Phase::drive && distance < last;
  if (phase_ == Phase::turn_to_heading || distance < near_enough || (is_last && ahead < near_enough / 2)) {
    // Turning on the spot may take it away a little, but not for ever.
    phase_ = Phase::turn_to_heading;
    return turn_to_heading(heading_error);
  }
  const double bearing = std::atan2(beside, ahead);
  if (is_last) return {speed_for(ahead, limits_), 0, 0};
  // Begins to drive when it looks straight at the goal, and turns again only when it has been turned away.
  if (phase_ == Phase::turn && std::abs(bearing) < 5 * straight_enough) phase_ = Phase::drive;
  if (phase_ == Phase::drive && std::abs(bearing) > straight) phase_ = Phase::turn;
  const double speed = phase_ == Phase::drive ? speed_for(distance, limits_) * std::cos(bearing) : 0;
  return {speed, 0, turn_for(bearing, limits_)};
}

}  // namespace shm
