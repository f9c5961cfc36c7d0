// Orientations and covariances of messages of ROS 2. Angles in rad: roll, pitch, yaw about the fixed x, y, z axes, in this order. Pure.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "ros/messages.h"

namespace ros {

struct Angles {
  double roll = 0, pitch = 0, yaw = 0;
};

inline Quaternion quaternion_of(const Angles& angles) {
  const double cr = std::cos(angles.roll / 2), sr = std::sin(angles.roll / 2), cp = std::cos(angles.pitch / 2);
  const double sp = std::sin(angles.pitch / 2), cy = std::cos(angles.yaw / 2), sy = std::sin(angles.yaw / 2);
  return {sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy};
}

// Of any length; all 0, which some programs send for "none", is no rotation.
inline Angles angles_of(const Quaternion& from) {
  const double length = std::sqrt(from.x * from.x + from.y * from.y + from.z * from.z + from.w * from.w);
  if (!(length > 0)) return {};
  const double x = from.x / length, y = from.y / length, z = from.z / length, w = from.w / length;
  return {std::atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), std::asin(std::clamp(2 * (w * y - z * x), -1.0, 1.0)),
          std::atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))};
}

inline std::array<double, 36> covariance_of(const std::array<double, 6>& diagonal) {
  std::array<double, 36> covariance{};
  for (std::size_t i = 0; i < diagonal.size(); ++i) covariance[i * 7] = diagonal[i];
  return covariance;
}
// Filters would take 0 for certainty.
inline constexpr double unknown_variance = 1e12;
inline std::array<double, 36> unknown_covariance() {
  constexpr double u = unknown_variance;
  return covariance_of({u, u, u, u, u, u});
}
// What wheels measure, and what they do not.
inline std::array<double, 36> wheel_covariance() {
  constexpr double flat = 1e-5, yaw = 1e-3, u = unknown_variance;
  return covariance_of({flat, flat, u, u, u, yaw});
}

}  // namespace ros
