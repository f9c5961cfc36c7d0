#include "physics/free_rotation.h"

#include <algorithm>
#include <cmath>

namespace sim {
namespace {

Eigen::Matrix3d inertia_of(dBodyID body) {
  dMass mass;
  dBodyGetMass(body, &mass);
  Eigen::Matrix3d inertia;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) inertia(row, column) = mass.I[4 * row + column];
  return inertia;
}

// The angular velocity in the world of a body with this angular momentum.
Eigen::Vector3d spin_of(const Eigen::Quaterniond& orientation, const Eigen::Matrix3d& inverse, const Eigen::Vector3d& momentum) {
  return orientation * (inverse * (orientation.conjugate() * momentum));
}

// Fourth-order Runge-Kutta.
Eigen::Quaterniond turned(const Eigen::Quaterniond& start, const Eigen::Matrix3d& inverse, const Eigen::Vector3d& momentum, double dt) {
  const auto rate = [&](const Eigen::Vector4d& q) {
    const Eigen::Quaterniond at = Eigen::Quaterniond(q).normalized();
    const Eigen::Vector3d half = 0.5 * spin_of(at, inverse, momentum);
    return Eigen::Vector4d((Eigen::Quaterniond(0, half.x(), half.y(), half.z()) * at).coeffs());
  };
  const Eigen::Vector4d q = start.coeffs();
  const Eigen::Vector4d a = rate(q), b = rate(q + 0.5 * dt * a), c = rate(q + 0.5 * dt * b), d = rate(q + dt * c);
  return Eigen::Quaterniond(Eigen::Vector4d(q + dt / 6 * (a + 2 * b + 2 * c + d))).normalized();
}

}  // namespace

void FreeRotation::add(dBodyID body) {
  if (dBodyGetJoint(body, 0) != nullptr || dBodyIsEnabled(body) == 0 || dBodyIsKinematic(body) != 0) return;
  const Eigen::Quaterniond orientation = ode::quaternion(dBodyGetQuaternion(body));
  const Eigen::Vector3d spin = orientation.conjugate() * ode::vector(dBodyGetAngularVel(body));
  const Eigen::Matrix3d inertia = inertia_of(body);
  // Part of the momentum that turns with the body.
  if (spin.cross(inertia * spin).norm() <= 1e-9 * inertia.trace() * spin.squaredNorm() || !spin.allFinite()) return;
  dBodySetGyroscopicMode(body, 0);
  turning_.push_back({body, orientation});
}

void FreeRotation::finish(double dt) {
  constexpr double largest_turn = 0.1;  // [rad] of one integration step
  constexpr int max_turns = 32;
  for (const auto& [body, start] : turning_) {
    dBodySetGyroscopicMode(body, 1);
    const Eigen::Matrix3d inertia = inertia_of(body), inverse = inertia.inverse();
    const Eigen::Vector3d spin = ode::vector(dBodyGetAngularVel(body));
    if (!spin.allFinite()) continue;
    const Eigen::Vector3d momentum = start * (inertia * (start.conjugate() * spin));
    const int turns = std::clamp(static_cast<int>(std::ceil(std::min(spin.norm() * dt / largest_turn, 1e3))), 1, max_turns);
    Eigen::Quaterniond orientation = start;
    for (int i = 0; i < turns; ++i) orientation = turned(orientation, inverse, momentum, dt / turns);
    const Eigen::Vector3d now = spin_of(orientation, inverse, momentum);
    const dQuaternion q = {orientation.w(), orientation.x(), orientation.y(), orientation.z()};
    dBodySetQuaternion(body, q);
    dBodySetAngularVel(body, now.x(), now.y(), now.z());
  }
  turning_.clear();
}

}  // namespace sim
