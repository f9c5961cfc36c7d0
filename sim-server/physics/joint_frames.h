// Points and directions between the world and the frame of a body; without a body its frame is the world. Private to physics/.
#pragma once

#include <numbers>

#include "physics/ode.h"

namespace sim {

constexpr double whole_turn = 2 * std::numbers::pi;  // [rad]

inline Eigen::Vector3d point_in(dBodyID body, const Eigen::Vector3d& point) {
  if (body == nullptr) return point;
  return ode::quaternion(dBodyGetQuaternion(body)).conjugate() * (point - ode::vector(dBodyGetPosition(body)));
}
inline Eigen::Vector3d direction_in(dBodyID body, const Eigen::Vector3d& direction) {
  return body == nullptr ? direction : ode::quaternion(dBodyGetQuaternion(body)).conjugate() * direction;
}
inline Eigen::Vector3d point_of(dBodyID body, const Eigen::Vector3d& point) {
  if (body == nullptr) return point;
  return ode::vector(dBodyGetPosition(body)) + ode::quaternion(dBodyGetQuaternion(body)) * point;
}
inline Eigen::Vector3d direction_of(dBodyID body, const Eigen::Vector3d& direction) {
  return body == nullptr ? direction : ode::quaternion(dBodyGetQuaternion(body)) * direction;
}

}  // namespace sim
