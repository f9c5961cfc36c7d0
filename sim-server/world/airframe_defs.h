// Aeroplanes, airships and hulls of boats whose forces are given as coefficients of the whole body: the plugins AdvancedLiftDrag and
// LighterThanAirDynamics of gz-sim. Pure; any thread.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "world/body_force_defs.h"
#include "world/world_def.h"

namespace sim {

// AdvancedLiftDrag: forces and moments of an aeroplane by its stability derivatives, in the axes of the body: x forward, y to the right,
// z down.
struct AirframeDef {
  enum Row { drag, side, lift, roll, pitch, yaw };
  enum Column { at_zero, by_alpha, by_beta, by_roll, by_pitch, by_yaw };  // rates as rate * span (pitch: chord) / (2 * speed)
  struct Surface {
    std::uint32_t joint = 0;
    Vector6 effect = Vector6::Zero();  // by row, for each degree of its joint
  };
  std::uint32_t link = 0;
  Matrix6 coefficients = Matrix6::Zero();
  double stall = 1.5707963267948966, pitch_stalled = 0;  // [rad]; of the pitching moment beyond the stall [1/rad]
  double area = 1, span = 1, chord = 1;                  // [m^2], [m]
  double aspect_ratio = 1, efficiency = 1, density = 1.2041;
  Eigen::Vector3d center{0, 0, 0};                    // of the forces, in the link [m]
  Eigen::Vector3d forward{1, 0, 0}, upward{0, 0, 1};  // unit, in the link
  std::vector<Surface> surfaces;
};

// LighterThanAirDynamics: what the air does to a hull that moves through it, after Li and Nahon (2007). The hull's x points forward.
struct AirshipDef {
  std::uint32_t link = 0;
  double density = 1.225;
  double force_inviscid = 0, force_viscous = 0, moment_inviscid = 0, moment_viscous = 0, axial_drag = 0;
  double separation = 0;  // behind the origin of the link, where the flow leaves the hull [m]
};

// Surface of VRX: a round hull, halved by the water at most, as slices around points. Each is lifted at its point; the water has no waves.
struct FloatingHullDef {
  std::uint32_t link = 0;
  std::vector<Eigen::Vector3d> points;  // in the link
  double radius = 0, length = 0;        // of the whole hull [m]
  double level = 0, density = 1000;     // height of the water [m], [kg/m^3]
};

// Of all such plugins of a model. One that is wrong adds a line to `left_out`.
std::vector<AirframeDef> airframes_of(const ModelDef& model, std::vector<std::string>& left_out);
std::vector<AirshipDef> airships_of(const ModelDef& model, std::vector<std::string>& left_out);
// `notes`: that there are no waves, where the file has some.
std::vector<FloatingHullDef> floating_hulls_of(const ModelDef& model, std::vector<std::string>& left_out, std::vector<std::string>& notes);

}  // namespace sim
