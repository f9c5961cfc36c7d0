// Controllers of vehicles with propellers: a commanded velocity becomes a speed or thrust of each propeller. The stepping thread only.
#pragma once

#include <memory>
#include <vector>

#include "devices/drives/propeller.h"
#include "world/body_force_defs.h"

namespace sim {

class VehicleControl {
 public:
  virtual ~VehicleControl() = default;
  // For the next step; the command is a velocity in the body's frame [m/s, rad/s].
  virtual void control(const Physics& physics, const Vector6& command, double dt, std::vector<Propellers::Wish>& wishes) = 0;
  virtual void reset() {}
  virtual void add_to(StateHash&) const {}
  virtual bool moves_sideways() const { return true; }
  virtual double max_speed() const = 0;     // [m/s]
  virtual double max_yaw_rate() const = 0;  // [rad/s]
};

// Mass, centre of mass and inertia of all links of a model at its start, in a frame of the model.
struct Weight {
  double mass = 0;
  Eigen::Vector3d center{0, 0, 0};
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre
};
Weight weight_of(const ModelDef& model, const Eigen::Isometry3d& frame);

// By the numbers of a plugin MulticopterVelocityControl, or without one by gains from the mass. Null, with a line, when the rotors cannot
// carry a body: fewer than four of them, or all in one line.
std::unique_ptr<VehicleControl> make_multicopter(const DeviceWorld& world, ModelId model, const PluginDef& plugin,
                                                 const Propellers& propellers, std::vector<std::string>& left_out);
// Of a boat or an underwater vehicle: as much of the velocity as its thrusters can give.
std::unique_ptr<VehicleControl> make_thruster_control(const Physics& physics, ModelId model, const Propellers& propellers);

}  // namespace sim
