#include "physics/aerodynamics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sim {
namespace {

constexpr double slowest_flow = 1e-9;                           // [m/s]
constexpr double blending = 15;                                 // of the model beyond the stall [1/rad]
constexpr double flat_plate_a = -0.224, flat_plate_b = -0.115;  // drag of a flat plate by its aspect ratio: 2 / (1 + exp(a + b AR))

// 0 below the stall, 1 beyond it.
double stalled_part(double alpha, double stall) {
  const double above = std::exp(-blending * (alpha - stall)), below = std::exp(blending * (alpha + stall));
  if (!std::isfinite(above) || !std::isfinite(below)) return std::abs(alpha) < stall ? 0 : 1;
  return (1 + above + below) / ((1 + above) * (1 + below));
}

// Linear with another slope beyond the stall.
double pitching_moment(const AirframeDef& def, double alpha) {
  const double within = std::clamp(alpha, -def.stall, def.stall);
  return def.coefficients(AirframeDef::pitch, AirframeDef::by_alpha) * within + def.pitch_stalled * (alpha - within);
}

}  // namespace

AirForce force_on(const AirframeDef& def, const Eigen::Vector3d& velocity, const Eigen::Vector3d& rate, std::span<const double> angles) {
  using A = AirframeDef;
  const Eigen::Vector3d x = def.forward, z = -def.upward, y = z.cross(x);
  const Eigen::Vector3d in_plane = velocity - velocity.dot(y) * y;
  const double speed = in_plane.norm();
  if (!(speed > slowest_flow)) return {};
  const Eigen::Vector3d along = in_plane / speed, down = along.cross(y);
  const double alpha = std::atan2(along.dot(z), along.dot(x)), beta = std::atan2(velocity.dot(y), velocity.dot(x));

  const double pressure = 0.5 * def.density * speed * speed;
  const Eigen::Vector3d rates = Eigen::Vector3d(rate.dot(x) * def.span, rate.dot(y) * def.chord, rate.dot(z) * def.span) / (2 * speed);
  Vector6 controls = Vector6::Zero();
  for (std::size_t i = 0; i < def.surfaces.size() && i < angles.size(); ++i)
    controls += angles[i] * 180 / std::numbers::pi * def.surfaces[i].effect;

  // Columns that are not linear are added below.
  Matrix6 linear = def.coefficients;
  linear(A::pitch, A::by_alpha) = linear(A::lift, A::by_alpha) = linear(A::lift, A::at_zero) = linear(A::drag, A::at_zero) = 0;
  Vector6 by;
  by << 1, alpha, beta, rates;
  Vector6 c = linear * by + controls;
  c[A::pitch] += pitching_moment(def, alpha);

  const double stalled = stalled_part(alpha, def.stall), sine = std::sin(alpha);
  const double lift = (1 - stalled) * (def.coefficients(A::lift, A::at_zero) + def.coefficients(A::lift, A::by_alpha) * alpha) +
                      stalled * std::copysign(2 * sine * sine * std::cos(alpha), alpha);
  c[A::lift] += lift;
  const double whole_lift = lift + def.coefficients(A::lift, A::by_beta) * beta + controls[A::lift];  // without the rates
  const double plate = 2 / (1 + std::exp(flat_plate_a + flat_plate_b * std::max(def.aspect_ratio, 1 / def.aspect_ratio)));
  c[A::drag] += (1 - stalled) * (def.coefficients(A::drag, A::at_zero) +
                                 whole_lift * whole_lift / (std::numbers::pi * def.aspect_ratio * def.efficiency)) +
                stalled * plate * (0.5 - 0.5 * std::cos(2 * alpha));

  const double scale = pressure * def.area;
  return {scale * (-c[A::lift] * down - c[A::drag] * along + c[A::side] * y),
          scale * (c[A::pitch] * def.chord * y + c[A::roll] * def.span * x + c[A::yaw] * def.span * z)};
}

AirForce force_on(const AirshipDef& def, const Eigen::Vector3d& velocity, const Eigen::Vector3d& rate) {
  const Eigen::Vector3d at_separation = velocity + rate.cross(Eigen::Vector3d(-def.separation, 0, 0));
  const double across = std::hypot(at_separation.y(), at_separation.z());
  const double pressure = 0.5 * def.density * at_separation.squaredNorm();
  const double angle = std::atan2(across, at_separation.x());
  const double sine = std::sin(angle), twice = std::sin(2 * angle);
  AirForce out;
  if (across > slowest_flow) {
    const double ny = at_separation.y() / across, nz = at_separation.z() / across;
    out.force = pressure * (-def.force_inviscid * twice + def.force_viscous * sine * sine) * Eigen::Vector3d(0, -ny, -nz);
    out.torque = pressure * (-def.moment_inviscid * twice + def.moment_viscous * sine * sine) * Eigen::Vector3d(0, nz, -ny);
  }
  // Against the motion also of a hull that goes backwards.
  const double ahead = std::cos(std::atan2(velocity.z(), velocity.x()));
  out.force.x() -= 0.5 * def.density * velocity.squaredNorm() * def.axial_drag * ahead * std::abs(ahead);
  return out;
}

double lift_on(const FloatingHullDef& hull, double depth, double gravity) {
  const double r = hull.radius, h = std::clamp(depth, 0.0, r);
  const double segment = r * r * std::acos((r - h) / r) - (r - h) * std::sqrt(2 * r * h - h * h);
  return segment * hull.length / static_cast<double>(hull.points.size()) * hull.density * gravity;
}

}  // namespace sim
