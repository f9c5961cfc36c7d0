#include "physics/joints.h"

#include <algorithm>
#include <cmath>

#include "physics/joint_frames.h"

namespace sim {
namespace {

using Kind = JointDef::Kind;

bool has_suspension(const JointDef& def) {
  if (def.suspension_cfm || def.suspension_erp) return true;
  return def.axes.size() == 2 && std::abs(def.axes[0].xyz.dot(def.axes[1].xyz)) > 1e-3;  // or axes that no cross has
}

JointSeat seat_on(dBodyID body, const Eigen::Isometry3d& frame, const Eigen::Vector3d& axis) {
  const Eigen::Quaterniond turn(frame.linear());
  return {point_in(body, frame.translation()), direction_in(body, axis),
          body == nullptr ? turn : ode::quaternion(dBodyGetQuaternion(body)).conjugate() * turn};
}

int axis_count_of(const JointDef& def) {
  return def.kind == Kind::gearbox ? 0 : static_cast<int>(std::min<std::size_t>(def.axes.size(), 2));
}

}  // namespace

JointInstance::JointInstance(dWorldID world, const PhysicsDef& physics, const JointDef& def, std::uint32_t index,
                             const Eigen::Isometry3d& frame, dBodyID parent, dBodyID child)
    : def_(&def), axis_count_(axis_count_of(def)), index_(index), world_(world), parent_(parent), child_(child) {
  make(world, frame);
  const Eigen::Vector3d axis = frame.linear() * (def.axes.empty() ? Eigen::Vector3d(0, 0, 1) : def.axes[0].xyz);
  seat_on_parent_ = seat_on(parent, frame, axis), seat_on_child_ = seat_on(child, frame, axis);
  if (joint_.id() == nullptr) return;
  if (def.provide_feedback || !def.sensors.empty()) {
    feedback_ = std::make_unique<dJointFeedback>();
    dJointSetFeedback(joint_.id(), feedback_.get());
  }
  for (int i = 0; i < axis_count(); ++i) set_axis(i, physics.step);
}

void JointInstance::make(dWorldID world, const Eigen::Isometry3d& frame) {
  const Eigen::Vector3d p = frame.translation();
  const auto axis = [&](std::size_t i) -> Eigen::Vector3d {
    return frame.linear() * (i < def_->axes.size() ? def_->axes[i].xyz : Eigen::Vector3d(0, 0, 1));
  };
  const Eigen::Vector3d a = axis(0), b = axis(1);
  const auto create = [&](dJointID joint, dBodyID first, dBodyID second) {
    joint_ = ode::Joint(joint);
    attach(joint, first, second);
    return joint;
  };
  switch (def_->kind) {
    case Kind::revolute:
    case Kind::continuous: {
      const dJointID joint = create(dJointCreateHinge(world, nullptr), child_, parent_);
      dJointSetHingeAnchor(joint, p.x(), p.y(), p.z());
      dJointSetHingeAxis(joint, a.x(), a.y(), a.z());
      break;
    }
    case Kind::prismatic:
      dJointSetSliderAxis(create(dJointCreateSlider(world, nullptr), child_, parent_), a.x(), a.y(), a.z());
      break;
    case Kind::fixed:
      dJointSetFixed(create(dJointCreateFixed(world, nullptr), child_, parent_));
      break;
    case Kind::ball:
      dJointSetBallAnchor(create(dJointCreateBall(world, nullptr), child_, parent_), p.x(), p.y(), p.z());
      break;
    case Kind::universal:
      make_universal(world, p, a, b);
      break;
    case Kind::revolute2: {
      // Without a spring it is the same thing, and ODE keeps limits of the second axis of that one only.
      if (!has_suspension(*def_)) {
        make_universal(world, p, a, b);
        break;
      }
      const dJointID joint = create(dJointCreateHinge2(world, nullptr), or_stand_in(parent_), or_stand_in(child_));
      sign_ = -1;
      dJointSetHinge2Anchor(joint, p.x(), p.y(), p.z());
      const dVector3 first = {a.x(), a.y(), a.z()}, second = {b.x(), b.y(), b.z()};
      dJointSetHinge2Axes(joint, first, second);
      if (def_->suspension_erp) dJointSetHinge2Param(joint, dParamSuspensionERP, std::clamp(*def_->suspension_erp, 0.0, 1.0));
      if (def_->suspension_cfm) dJointSetHinge2Param(joint, dParamSuspensionCFM, std::clamp(*def_->suspension_cfm, 0.0, 1e9));
      break;
    }
    case Kind::screw:
      make_screw(world, frame);
      break;
    case Kind::gearbox:
      make_gearbox(frame);
      break;
  }
}

void JointInstance::make_universal(dWorldID world, const Eigen::Vector3d& place, const Eigen::Vector3d& first,
                                   const Eigen::Vector3d& second) {
  joint_ = ode::Joint(dJointCreateUniversal(world, nullptr));
  const dJointID joint = joint_.id();
  dJointAttach(joint, or_stand_in(parent_), or_stand_in(child_));
  sign_ = -1;
  dJointSetUniversalAnchor(joint, place.x(), place.y(), place.z());
  dJointSetUniversalAxis1(joint, first.x(), first.y(), first.z());
  dJointSetUniversalAxis2(joint, second.x(), second.y(), second.z());
}

// With the world first ODE tells the position in the sense that was asked for, and takes motors and stops in the other.
void JointInstance::attach(dJointID joint, dBodyID first, dBodyID second) {
  if (first != nullptr) return dJointAttach(joint, first, second);
  sign_ = -1;
  dJointAttach(joint, second, nullptr);
}

// ODE's joints with two axes count wrongly, or refuse to work, with the world on one side: there a body that nothing can move stands for
// it.
dBodyID JointInstance::or_stand_in(dBodyID body) {
  if (body != nullptr) return body;
  stand_in_ = ode::Body(dBodyCreate(world_));
  dBodySetKinematic(stand_in_.id());
  dBodySetAutoDisableFlag(stand_in_.id(), 1);
  dBodySetAutoDisableSteps(stand_in_.id(), 10);
  dBodySetAutoDisableTime(stand_in_.id(), 0);
  return stand_in_.id();
}

void JointInstance::set_axis(int i, double dt) {
  const AxisDef& axis = def_->axes[static_cast<std::size_t>(i)];
  read_stops(i, dt);
  const bool has_stops = std::isfinite(axis.lower) || std::isfinite(axis.upper);
  auto& damping = damping_[static_cast<std::size_t>(i)];
  if (axis.friction > 0) {
    set_parameter(i, dParamVel, 0);
    set_parameter(i, dParamFMax, axis.friction);
    damping = axis.damping;
  } else if (axis.damping > 0 && !has_stops) {
    // A motor that stands still and gives way: an exact, implicit damper. (With stops ODE would add the endless force explicitly.)
    set_parameter(i, dParamVel, 0);
    set_parameter(i, dParamFMax, dInfinity);
    set_parameter(i, dParamCFM, 1 / axis.damping);
  } else {
    damping = axis.damping;
  }
  has_forces_ = has_forces_ || damping > 0 || axis.spring_stiffness != 0;
}

void JointInstance::set_drive(int axis, double velocity, double effort) {
  if (axis >= axis_count()) return;
  auto& drive = drives_[static_cast<std::size_t>(axis)];
  const AxisDef& def = def_->axes[static_cast<std::size_t>(axis)];
  if (!drive.is_set) {
    set_parameter(axis, dParamCFM, 1e-10);
    damping_[static_cast<std::size_t>(axis)] = def.damping;
    has_forces_ = has_forces_ || def.damping > 0;
  }
  drive = {velocity, effort, true};
  // Files of wheels say 0 where they mean none.
  const double most = def.velocity > 0 ? def.velocity : infinite;
  set_parameter(axis, dParamVel, effort > 0 ? sign_ * std::clamp(velocity, -most, most) : 0);
  set_parameter(axis, dParamFMax, effort > 0 ? effort : def.friction);
}

void JointInstance::set_row(const JointRow& row, bool is_in_tree) {
  if (!has_row_) {
    set_drive(0, 0, 0);
    has_row_ = has_forces_ = true;
  }
  row_ = row;
  drives_[0] = {row.velocity, row.most, true};
  double most = row.most;
  // At a stop ODE's own solver makes a motor an effort of all its strength.
  if (most > 0 && !is_in_tree && stops_[0].exists() && is_at_stop())
    most = std::min(most, std::abs(row.velocity - state(0).velocity) / std::max(row.give, 1e-9));
  set_parameter(0, dParamVel, row.most > 0 ? sign_ * row.velocity : 0);
  set_parameter(0, dParamFMax, row.most > 0 ? most : def_->axes[0].friction);
  set_parameter(0, dParamCFM, row.most > 0 ? std::max(row.give, 1e-10) : 1e-10);
}

bool JointInstance::is_asleep() const {
  return (parent_ == nullptr || dBodyIsEnabled(parent_) == 0) && (child_ == nullptr || dBodyIsEnabled(child_) == 0);
}

void JointInstance::apply(dJointGroupID step_joints, double dt) {
  // ODE keeps forces on sleeping bodies until they wake, and would add up those of every step.
  if (is_asleep()) return;
  if (row_.push != 0) add_effort(0, row_.push);
  for (int i = 0; i < axis_count() && has_forces_; ++i) {
    const AxisDef& axis = def_->axes[static_cast<std::size_t>(i)];
    const double damping = damping_[static_cast<std::size_t>(i)];
    if (damping <= 0 && axis.spring_stiffness == 0) continue;
    const JointState now = state(i);
    // The damping of one step must not turn the motion round.
    double effort = -std::min(damping, 0.5 * inertia_along(i) / dt) * now.velocity;
    effort -= axis.spring_stiffness * (now.position - axis.spring_reference);
    if (effort != 0 && std::isfinite(effort)) add_effort(i, effort);
  }
  if (coupling_) couple(step_joints, dt);
}

}  // namespace sim
