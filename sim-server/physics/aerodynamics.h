// Forces of the air on aeroplanes and airships that are given by coefficients (world/airframe_defs.h). Pure; any thread.
#pragma once

#include <span>

#include "world/airframe_defs.h"

namespace sim {

struct AirForce {
  Eigen::Vector3d force{0, 0, 0};   // [N]
  Eigen::Vector3d torque{0, 0, 0};  // [N m]
};

// In the link, at the centre of the forces. `velocity` of that point through the air [m/s] and `rate` of the link [rad/s], in the link;
// `angles` of the joints of its surfaces [rad], in their order.
AirForce force_on(const AirframeDef& airframe, const Eigen::Vector3d& velocity, const Eigen::Vector3d& rate,
                  std::span<const double> angles);

// In the link, at its origin, of whose motion velocity and rate are. The forces of the added mass are not among these.
AirForce force_on(const AirshipDef& airship, const Eigen::Vector3d& velocity, const Eigen::Vector3d& rate);

// Of a slice of a hull whose point is `depth` below the water: the lift that its gravity [m/s^2] gives [N].
double lift_on(const FloatingHullDef& hull, double depth, double gravity);

}  // namespace sim
