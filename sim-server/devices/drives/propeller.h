// Propellers of a model: joints that push when they turn. gz-sim's Thruster (in water) and MulticopterMotorModel (in air; its predecessors
// in Gazebo classic have the same elements). The stepping thread only, one thread for each model.
//
// A thruster pushes with the commanded thrust at once, as in gz-sim; its joint follows with its motor or controller. A rotor pushes by the
// speed of its joint, which follows the commanded speed with a time constant. The joint is slower than the rotor by a factor, because a
// rotor of a few grams turns several radians in a step.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "devices/device.h"

namespace sim {

class Propeller {
 public:
  struct Setup {
    JointId joint;
    LinkId link, parent;  // that it turns, and that it hangs on; the same: nothing of the model
    bool is_rotor = false;
    double constant = 1;                                           // thrust for each (rad/s)^2 [N s^2]
    double max_speed = 838;                                        // [rad/s]
    double least_thrust = -1000, max_thrust = 1000, deadband = 0;  // [N]
    double direction = 1;                                          // -1: a rotor that pushes up when its joint turns backwards
    // Of rotors.
    double slowdown = 10, moment = 0.016, drag = 1e-4, rolling = 1e-6;
    double rising = 0.0125, falling = 0.025;  // [s] time constants
    // Of thrusters.
    bool has_motor = false;                        // the joint turns as told, whatever it takes; else by the gains
    double p = 0.1, i = 0, d = 0;                  // [N m s], ...
    std::optional<double> alpha_1, alpha_2, wake;  // the coefficient follows the speed through the water
    double scale = 1, diameter = 1;                // density times diameter^4; [m]
    std::string source;                            // "file:line" of the plugin
  };
  Propeller(Physics& physics, const Setup& setup, double dt);

  const Setup& setup() const { return setup_; }
  std::uint32_t joint() const { return setup_.joint.joint; }
  Eigen::Vector3d axis() const { return axis_; }  // of the thrust, in the link
  double max_thrust() const;                      // [N]
  // Least and most of a command: speeds [rad/s] or thrusts [N].
  std::pair<double, double> range(bool is_thrust) const;

  // What is asked for from the next step on.
  void set_speed(double speed);                                 // [rad/s]
  void set_thrust(double thrust);                               // [N]
  void set_strength(double strength) { strength_ = strength; }  // the part of its highest thrust that is left
  void before_step(Physics& physics, const Eigen::Vector3d& wind, double dt);

  double speed(const Physics& physics) const;  // now [rad/s]
  double thrust() const { return thrust_; }    // in the last step [N]
  void reset();
  void add_to(StateHash& hash) const;

 private:
  void turn_rotor(Physics& physics, const Eigen::Vector3d& wind);
  void turn_thruster(Physics& physics, double dt);
  double constant_now(const Physics& physics, double speed) const;

  Setup setup_;
  Eigen::Vector3d axis_{0, 0, 1}, joint_axis_{0, 0, 1};  // in the link
  Eigen::Vector3d center_{0, 0, 0};                      // of the link's mass, in the link
  double inertia_ = 1;                                   // of the link about the axis [kg m^2]
  double keep_rising_ = 0, keep_falling_ = 0;            // of the filter, each step
  double wanted_speed_ = 0, wanted_thrust_ = 0, filtered_ = 0;
  double integral_ = 0, last_error_ = 0;
  double thrust_ = 0, strength_ = 1;
  bool is_by_speed_ = false;  // asked for
};

// Those of a model; commanded by two devices, by the client of single joints first.
class Propellers {
 public:
  // Nothing, when the model has none. A plugin that names no such joint, one of `driven` (joints, and what drives them), or one that has a
  // propeller already, adds a line.
  static std::shared_ptr<Propellers> of(DeviceWorld& world, ModelId model, const std::map<std::uint32_t, std::string>& driven,
                                        std::vector<std::string>& left_out);

  std::vector<Propeller>& all() { return all_; }
  const std::vector<Propeller>& all() const { return all_; }
  // The place of the one that this joint turns.
  std::optional<std::size_t> find(std::uint32_t joint) const;
  // What the vehicle asks of those that no client of single joints commands.
  struct Wish {
    bool is_thrust = false;
    double value = 0;
  };
  std::vector<Wish> wishes;    // of the vehicle, by place
  std::vector<Wish> followed;  // what each follows; one that is halted goes on with it

 private:
  std::vector<Propeller> all_;
};

}  // namespace sim
