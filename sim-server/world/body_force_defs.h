// Forces that water and air put on a link, as the plugins Hydrodynamics and LiftDrag of gz-sim (and of Gazebo classic) describe them. Pure;
// any thread.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "world/world_def.h"

namespace sim {

using Vector6 = Eigen::Matrix<double, 6, 1>;  // linear, angular
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// On a link, in its frame and at its origin, for its velocity v against the water. Signs are Fossen's: the numbers of a body that the water
// slows down are negative.
struct HydrodynamicsDef {
  // A force or torque `to` for each v[by] * v[with], or v[by] * |v[with]|.
  struct Product {
    int to = 0, by = 0, with = 0;
    bool is_absolute = true;
    double value = 0;
  };
  std::uint32_t link = 0;            // index into ModelDef::links
  Matrix6 linear = Matrix6::Zero();  // force for each velocity
  std::vector<Product> quadratic;    // those that are not zero
  Matrix6 added = Matrix6::Zero();   // force for each acceleration
  bool has_coriolis = true;          // of the added mass
  bool has_munk = true;              // its moment of the velocity alone is among those; an airship's plugin has one of its own
  Eigen::Vector3d current{0, 0, 0};  // of the water, in the world [m/s]
};

// A wing, sail, fin or blade: lift and drag at its centre of pressure, by the angle of attack.
struct WingDef {
  std::uint32_t link = 0;
  double a0 = 0, stall = 1.5707963267948966;          // [rad]
  double lift = 1, drag = 0.01;                       // coefficients for each radian
  double lift_stalled = 0, drag_stalled = 1;          // beyond the stall
  double area = 1, density = 1.2041;                  // [m^2], [kg/m^3]
  bool is_radial = false;                             // symmetric about `forward`: upward follows the flow
  Eigen::Vector3d center{0, 0, 0};                    // of pressure, in the link [m]
  Eigen::Vector3d forward{1, 0, 0}, upward{0, 0, 1};  // unit, in the link
  std::optional<std::uint32_t> control_joint;         // changes the lift
  double lift_by_joint = 4;                           // for each radian of that joint
};

// Of all such plugins of a model. One that names no link or joint of the model, or has a number that is not finite, adds a line to
// `left_out`. Positive numbers, of files from before Fossen's signs, are turned, with a line in `notes`: they would drive the body.
std::vector<HydrodynamicsDef> hydrodynamics_of(const ModelDef& model, std::vector<std::string>& left_out, std::vector<std::string>& notes);
std::vector<WingDef> wings_of(const ModelDef& model, std::vector<std::string>& left_out);

// A force on a model ("box") or link ("box::lid") in every step, in the world, at the origin of the link.
struct StandingWrench {
  std::string entity;
  Eigen::Vector3d force{0, 0, 0}, torque{0, 0, 0};  // [N], [N m]
  std::string source;                               // "file:line" of the plugin
};
// Those of the plugins ApplyLinkWrench of a world. One that names neither a model nor a link adds a line to `left_out`.
std::vector<StandingWrench> standing_wrenches_of(const WorldDef& world, std::vector<std::string>& left_out);

// The wind of a world. Without a plugin WindEffects it blows from the beginning on and does not change.
struct WindDef {
  Eigen::Vector3d velocity{0, 0, 0};   // when it has risen [m/s]
  double scale = 1;                    // of the force: mass times velocity against the wind [1/s]
  bool rises = false;                  // from 0 at the start
  double time = 1, vertical_time = 1;  // constants of that [s]
  double amplitude = 0, period = 1;    // of its strength, a fraction; [s]
  double swing = 0, swing_period = 1;  // of its direction [rad]; [s]
};
// Noise that a plugin asks for adds a line to `left_out`.
WindDef wind_of(const WorldDef& world, std::vector<std::string>& left_out);

// The link or joint of the model that a plugin of this scope means by a name: in its scope first.
std::optional<std::uint32_t> link_named(const ModelDef& model, const std::string& scope, const std::string& name);
std::optional<std::uint32_t> joint_named(const ModelDef& model, const std::string& scope, const std::string& name);
// That of <link_name>; else a line.
std::optional<std::uint32_t> link_of_plugin(const ModelDef& model, const PluginDef& plugin, std::vector<std::string>& left_out);
// Neither is 0, and they are not parallel.
bool are_two_directions(const Eigen::Vector3d& a, const Eigen::Vector3d& b);
// Three numbers; the fallback when there are not three finite ones.
Eigen::Vector3d vector_of(const ParameterNode& parameters, std::string_view name, const Eigen::Vector3d& fallback);

}  // namespace sim
