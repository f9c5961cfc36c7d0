// The rows of constraints that a joint makes between a body and what it hangs on: those that ODE has for hinges, sliders, balls and welds,
// their motors and stops. A row asks for a velocity across the joint and has an impulse within bounds [N s, N m s]. Private to physics/.
// Values; one thread at a time.
#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>

#include "physics/bounded_system.h"
#include "physics/joints.h"
#include "physics/ode.h"

namespace sim {

using Vector6 = Eigen::Matrix<double, 6, 1>;  // linear, angular
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Of a force along `line` at `arm` from the middle of a body; about the middle.
Vector6 wrench(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular);
Vector6 wrench_at(const Eigen::Vector3d& line, const Eigen::Vector3d& arm);
Vector6 velocity_of(dBodyID body);
// Two lines across the axis.
std::pair<Eigen::Vector3d, Eigen::Vector3d> plane_of(const Eigen::Vector3d& axis);

struct TreeRow {
  Vector6 own, parent;  // on the velocities of the body and of what it hangs on
  double target = 0, give = 0;
  double low = -infinite, high = infinite;  // of its impulse
  Bound bound = Bound::free;
  double impulse = 0;
  bool is_free() const { return bound == Bound::free; }
};

class JointRows {
 public:
  static constexpr int most = 8;  // five, a motor, a stop and a rotor

  struct Body {
    dBodyID body = nullptr;
    bool is_child = false;  // of the joint
  };
  // `dt`: the step [s].
  void make(JointInstance& joint, const Body& body, dWorldID world, double dt);
  void clear() { count_ = 0, motor_ = -1; }

  TreeRow* begin() { return rows_.data(); }
  TreeRow* end() { return rows_.data() + count_; }
  const TreeRow* begin() const { return rows_.data(); }
  const TreeRow* end() const { return rows_.data() + count_; }
  const TreeRow* motor() const { return motor_ < 0 ? nullptr : &rows_[static_cast<std::size_t>(motor_)]; }
  // Of a joint with one axis: its rate, from the velocities of the two bodies.
  const Vector6& axis_own() const { return axis_own_; }
  const Vector6& axis_parent() const { return axis_parent_; }

 private:
  void add(const Vector6& on_child, const Vector6& on_parent, double target, double give, double low, double high);
  void add_axis(JointInstance& joint, const Vector6& of_child, const Vector6& of_parent);
  void add_rotor(const JointInstance& joint, const Vector6& on_child, const Vector6& on_parent);
  void add_stop(const JointInstance& joint, const Vector6& on_child, const Vector6& on_parent, bool& is_locked);

  std::array<TreeRow, most> rows_;
  int count_ = 0, motor_ = -1;
  bool is_child_ = false;
  double dt_ = 0;
  Vector6 axis_own_, axis_parent_;
};

}  // namespace sim
