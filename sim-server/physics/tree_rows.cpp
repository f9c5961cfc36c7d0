#include "physics/tree_rows.h"

#include <cmath>

namespace sim {
namespace {

// The seat of a joint in the world, and the middle of its body.
struct Seated {
  Eigen::Vector3d middle{0, 0, 0}, place, axis;
  Eigen::Quaterniond turn;
};
Seated seated(dBodyID body, const JointSeat& seat) {
  if (body == nullptr) return {{0, 0, 0}, seat.place, seat.axis, seat.turn};
  const Eigen::Vector3d middle = ode::vector(dBodyGetPosition(body));
  const Eigen::Quaterniond q = ode::quaternion(dBodyGetQuaternion(body));
  return {middle, middle + q * seat.place, q * seat.axis, q * seat.turn};
}

double axis_parameter(dJointID joint, int which) {
  return dJointGetType(joint) == dJointTypeSlider ? dJointGetSliderParam(joint, which) : dJointGetHingeParam(joint, which);
}

}  // namespace

Vector6 wrench(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) {
  Vector6 out;
  out << linear, angular;
  return out;
}

Vector6 wrench_at(const Eigen::Vector3d& line, const Eigen::Vector3d& arm) { return wrench(line, arm.cross(line)); }

Vector6 velocity_of(dBodyID body) { return wrench(ode::vector(dBodyGetLinearVel(body)), ode::vector(dBodyGetAngularVel(body))); }

std::pair<Eigen::Vector3d, Eigen::Vector3d> plane_of(const Eigen::Vector3d& axis) {
  dVector3 p, q;
  const dVector3 n = {axis.x(), axis.y(), axis.z()};
  dPlaneSpace(n, p, q);
  return {ode::vector(p), ode::vector(q)};
}

void JointRows::add(const Vector6& on_child, const Vector6& on_parent, double target, double give, double low, double high) {
  TreeRow& row = rows_[static_cast<std::size_t>(count_++)];
  row.own = is_child_ ? on_child : on_parent;
  row.parent = is_child_ ? on_parent : on_child;
  row.target = target;
  row.give = give / dt_;
  row.low = low * dt_, row.high = high * dt_;
  row.bound = Bound::free;
  row.impulse = 0;
}

void JointRows::make(JointInstance& joint, const Body& body, dWorldID world, double dt) {
  is_child_ = body.is_child, dt_ = dt;
  const dBodyID first = dJointGetBody(joint.id(), 0), second = dJointGetBody(joint.id(), 1);
  const dBodyID other = first == body.body ? second : first;
  // ODE has the child first, unless only the parent has a body.
  const Seated on_child = seated(is_child_ ? body.body : other, joint.seat_on_child());
  const Seated on_parent = seated(is_child_ ? other : body.body, joint.seat_on_parent());
  const double correction = dWorldGetERP(world) / dt, give = dWorldGetCFM(world);
  const auto equal = [&](const Vector6& c, const Vector6& p, double target) { add(c, p, target, give, -infinite, infinite); };
  const auto turn_row = [&](const Eigen::Vector3d& line, double target) {
    equal(wrench({0, 0, 0}, line), wrench({0, 0, 0}, -line), target);
  };
  const Eigen::Vector3d apart = on_parent.place - on_child.place;
  const int type = dJointGetType(joint.id());
  if (type != dJointTypeSlider) {
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d line = Eigen::Vector3d::Unit(i);
      equal(wrench_at(line, on_child.place - on_child.middle), wrench_at(-line, on_parent.place - on_parent.middle), correction * apart[i]);
    }
  }
  if (type == dJointTypeSlider || type == dJointTypeFixed) {
    const Eigen::Quaterniond off = on_parent.turn * on_child.turn.conjugate();
    const Eigen::Vector3d turned = (off.w() < 0 ? -2.0 : 2.0) * off.vec();
    for (int i = 0; i < 3; ++i) turn_row(Eigen::Vector3d::Unit(i), correction * turned[i]);
  }
  const auto [p, q] = plane_of(on_child.axis);
  const Eigen::Vector3d child_arm = on_child.place - on_child.middle, parent_arm = on_child.place - on_parent.middle;
  if (type == dJointTypeHinge) {
    const Eigen::Vector3d lean = on_child.axis.cross(on_parent.axis);
    turn_row(p, correction * p.dot(lean));
    turn_row(q, correction * q.dot(lean));
    add_axis(joint, wrench({0, 0, 0}, on_child.axis), wrench({0, 0, 0}, -on_child.axis));
  } else if (type == dJointTypeSlider) {
    for (const auto& line : {p, q}) equal(wrench_at(line, child_arm), wrench_at(-line, parent_arm), correction * line.dot(apart));
    add_axis(joint, wrench_at(on_child.axis, child_arm), wrench_at(-on_child.axis, parent_arm));
  }
}

// The motor and the stops of a joint with one axis, in ODE's sense.
void JointRows::add_axis(JointInstance& joint, const Vector6& of_child, const Vector6& of_parent) {
  axis_own_ = is_child_ ? of_child : of_parent;
  axis_parent_ = is_child_ ? of_parent : of_child;
  const Vector6 on_child = joint.sign() * of_child, on_parent = joint.sign() * of_parent;
  bool is_locked = false;
  add_rotor(joint, on_child, on_parent);
  add_stop(joint, on_child, on_parent, is_locked);
  const double effort = axis_parameter(joint.id(), dParamFMax);
  if (!(effort > 0) || is_locked) return;
  add(on_child, on_parent, axis_parameter(joint.id(), dParamVel), axis_parameter(joint.id(), dParamCFM), -effort, effort);
  // Begins where it was in the last step: a motor at its limit is there for many steps.
  motor_ = count_ - 1;
  TreeRow& motor = rows_[static_cast<std::size_t>(motor_)];
  motor.bound = joint.motor_bound;
  if (!motor.is_free()) motor.impulse = motor.bound == Bound::low ? motor.low : motor.high;
}

// What keeps the rate that it has as the inertia of a rotor does.
void JointRows::add_rotor(const JointInstance& joint, const Vector6& on_child, const Vector6& on_parent) {
  const double inertia = joint.def().axes[0].rotor_inertia;
  if (!(inertia > 0)) return;
  add(on_child, on_parent, joint.sign() * joint.within_turn(0).velocity, dt_ / inertia, -infinite, infinite);
}

void JointRows::add_stop(const JointInstance& joint, const Vector6& on_child, const Vector6& on_parent, bool& is_locked) {
  const dJointID id = joint.id();
  const bool slides = dJointGetType(id) == dJointTypeSlider;
  const double low = axis_parameter(id, dParamLoStop), high = axis_parameter(id, dParamHiStop);
  const bool has_stops = slides ? std::isfinite(low) || std::isfinite(high) : low >= -M_PI || high <= M_PI;
  if (!has_stops || !(low <= high)) return;
  const double position = joint.sign() * joint.within_turn(0).position;
  const bool is_low = position <= low;
  if (!is_low && !(position >= high)) return;
  is_locked = low == high;
  const double correction = axis_parameter(id, dParamStopERP) / dt_;
  add(on_child, on_parent, -correction * (position - (is_low ? low : high)), axis_parameter(id, dParamStopCFM),
      is_low && !is_locked ? 0 : -infinite, is_low || is_locked ? infinite : 0);
}

}  // namespace sim
