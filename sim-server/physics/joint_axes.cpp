// The axes of a joint in ODE: position, rate, effort, inertia and load, and ODE's parameters of an axis.
#include <algorithm>
#include <cmath>

#include "physics/joint_frames.h"
#include "physics/joints.h"

namespace sim {
namespace {

// The body's inertia about an axis in the world.
double inertia_about(dBodyID body, const Eigen::Vector3d& axis) {
  if (dBodyIsKinematic(body) != 0) return infinite;
  dMass mass;
  dBodyGetMass(body, &mass);
  const Eigen::Vector3d local = ode::quaternion(dBodyGetQuaternion(body)).conjugate() * axis;
  const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> inertia(mass.I);
  return local.dot(inertia.leftCols<3>() * local);
}

// All that ODE computes the state of a hinge from.
std::array<double, 14> turning_of(dJointID hinge) {
  std::array<double, 14> all{};
  auto to = all.begin();
  for (const int side : {0, 1}) {
    const dBodyID body = dJointGetBody(hinge, side);
    if (body == nullptr) continue;
    to = std::copy_n(dBodyGetQuaternion(body), 4, to);
    to = std::copy_n(dBodyGetAngularVel(body), 3, to);
  }
  return all;
}

}  // namespace

bool JointInstance::turns(int) const { return dJointGetType(joint_.id()) != dJointTypeSlider; }

// One with a thread. Its place along the axis counts the turns.
bool JointInstance::is_screw() const { return dJointGetType(joint_.id()) == dJointTypePiston; }

JointState JointInstance::state(int axis) const {
  JointState now = within_turn(axis);
  if (const int turns = axis < axis_count_ ? places_[static_cast<std::size_t>(axis)].turns : 0; turns != 0)
    now.position += turns * whole_turn;
  return now;
}

JointState JointInstance::within_turn(int axis) const {
  const dJointID joint = joint_.id();
  if (joint == nullptr || axis >= axis_count()) return {};
  double position = 0, rate = 0;
  switch (dJointGetType(joint)) {
    case dJointTypeHinge:
      return seen_ && seen_->bodies == turning_of(joint) ? seen_->state : hinge_state();
    case dJointTypeSlider:
      position = dJointGetSliderPosition(joint), rate = dJointGetSliderPositionRate(joint);
      break;
    case dJointTypePiston:
      // The place of the nut knows the whole turns as well.
      position = dJointGetPistonPosition(joint) / coupling_->ratio, rate = dJointGetPistonAngleRate(joint);
      break;
    case dJointTypeUniversal:
      position = axis == 0 ? dJointGetUniversalAngle1(joint) : dJointGetUniversalAngle2(joint);
      rate = axis == 0 ? dJointGetUniversalAngle1Rate(joint) : dJointGetUniversalAngle2Rate(joint);
      break;
    case dJointTypeHinge2:
      // ODE gives this second angle with the other sign than its rate.
      position = axis == 0 ? dJointGetHinge2Angle1(joint) : -dJointGetHinge2Angle2(joint);
      rate = axis == 0 ? dJointGetHinge2Angle1Rate(joint) : dJointGetHinge2Angle2Rate(joint);
      break;
    default:
      break;
  }
  return {sign_ * position, sign_ * rate};
}

JointState JointInstance::hinge_state() const {
  return {sign_ * dJointGetHingeAngle(joint_.id()), sign_ * dJointGetHingeAngleRate(joint_.id())};
}

// Readers of several threads compare with it: only the stepping thread writes it.
void JointInstance::remember_hinge() {
  const dJointID joint = joint_.id();
  if (joint == nullptr || dJointGetType(joint) != dJointTypeHinge) return;
  if (!seen_) seen_ = std::make_unique<Seen>();
  *seen_ = {turning_of(joint), hinge_state()};
}

std::uint32_t JointInstance::rows() const {
  std::uint32_t rows = coupling_ ? 1 : 0;
  if (joint_.id() == nullptr) return rows;
  switch (dJointGetType(joint_.id())) {
    case dJointTypeBall:
      return rows + 3;
    case dJointTypeFixed:
      return rows + 6;
    case dJointTypeHinge:
    case dJointTypeSlider:
      rows += 5;
      break;
    default:
      rows += 4;
      break;
  }
  for (int i = 0; i < axis_count(); ++i) {
    const AxisDef& axis = def_->axes[static_cast<std::size_t>(i)];
    if (axis.friction > 0 || axis.damping > damping_[static_cast<std::size_t>(i)]) ++rows;
  }
  return rows;
}

void JointInstance::set_parameter(int axis, int base_parameter, double value) {
  const dJointID joint = joint_.id();
  const int parameter = axis == 0 ? base_parameter : base_parameter + dParamGroup;
  switch (dJointGetType(joint)) {
    case dJointTypeHinge:
      dJointSetHingeParam(joint, parameter, value);
      break;
    case dJointTypeSlider:
      dJointSetSliderParam(joint, parameter, value);
      break;
    case dJointTypePiston:
      // Motor, friction and damping turn; the stops hold the way.
      dJointSetPistonParam(joint, base_parameter + dParamGroup, value);
      break;
    case dJointTypeUniversal:
      dJointSetUniversalParam(joint, parameter, value);
      break;
    case dJointTypeHinge2:
      dJointSetHinge2Param(joint, parameter, value);
      break;
    default:
      break;
  }
}

bool JointInstance::takes_effort() const {
  if (joint_.id() == nullptr) return false;
  const auto type = dJointGetType(joint_.id());
  return type == dJointTypeHinge || type == dJointTypeSlider || type == dJointTypePiston || type == dJointTypeUniversal ||
         type == dJointTypeHinge2;
}

void JointInstance::add_effort(int axis, double effort) {
  const dJointID joint = joint_.id();
  const double signed_effort = sign_ * effort;
  const double first = axis == 0 ? signed_effort : 0, second = axis == 0 ? 0 : signed_effort;
  switch (dJointGetType(joint)) {
    case dJointTypeHinge:
      dJointAddHingeTorque(joint, signed_effort);
      break;
    case dJointTypeSlider:
      dJointAddSliderForce(joint, signed_effort);
      break;
    case dJointTypePiston: {
      const Eigen::Vector3d torque = axis_in_world(0) * effort;
      if (child_ != nullptr) dBodyAddTorque(child_, torque.x(), torque.y(), torque.z());
      if (parent_ != nullptr) dBodyAddTorque(parent_, -torque.x(), -torque.y(), -torque.z());
      break;
    }
    case dJointTypeUniversal:
      dJointAddUniversalTorques(joint, first, second);
      break;
    case dJointTypeHinge2:
      dJointAddHinge2Torques(joint, first, second);
      break;
    default:
      break;
  }
}

Eigen::Vector3d JointInstance::axis_in_world(int axis) const {
  dVector3 a = {0, 0, 1};
  switch (dJointGetType(joint_.id())) {
    case dJointTypeHinge:
      dJointGetHingeAxis(joint_.id(), a);
      break;
    case dJointTypeSlider:
      dJointGetSliderAxis(joint_.id(), a);
      break;
    case dJointTypePiston:
      dJointGetPistonAxis(joint_.id(), a);
      break;
    case dJointTypeUniversal:
      axis == 0 ? dJointGetUniversalAxis1(joint_.id(), a) : dJointGetUniversalAxis2(joint_.id(), a);
      break;
    case dJointTypeHinge2:
      axis == 0 ? dJointGetHinge2Axis1(joint_.id(), a) : dJointGetHinge2Axis2(joint_.id(), a);
      break;
    default:
      break;
  }
  return ode::vector(a);
}

// What an effort of the axis has to move.
double JointInstance::inertia_along(int axis) const {
  const Eigen::Vector3d direction = axis_in_world(axis);
  double inverse = 0;
  for (const dBodyID body : {parent_, child_}) {
    if (body == nullptr) continue;
    dMass mass;
    dBodyGetMass(body, &mass);
    const double own = turns(axis) ? inertia_about(body, direction) : (dBodyIsKinematic(body) != 0 ? infinite : mass.mass);
    inverse += 1 / own;
  }
  return inverse > 0 ? 1 / inverse : infinite;
}

std::optional<Wrench> JointInstance::load() const {
  if (!feedback_) return std::nullopt;
  const bool is_child_first = child_ != nullptr ? dJointGetBody(joint_.id(), 0) == child_ : dJointGetBody(joint_.id(), 0) != parent_;
  // With the world on one side ODE gives what acts on the body.
  const bool is_single = (child_ == nullptr || parent_ == nullptr) && stand_in_.id() == nullptr;
  const bool takes_first = is_single || is_child_first;
  Wrench wrench;
  wrench.force = ode::vector(takes_first ? feedback_->f1 : feedback_->f2);
  wrench.torque = ode::vector(takes_first ? feedback_->t1 : feedback_->t2);
  if (child_ == nullptr && parent_ != nullptr && is_single) {
    // It acts on the parent, at the parent's centre; the child gets the opposite.
    wrench.force = -wrench.force;
    wrench.torque = -wrench.torque;
    wrench.place = ode::vector(dBodyGetPosition(parent_));
  } else if (child_ != nullptr) {
    wrench.place = ode::vector(dBodyGetPosition(child_));
  }
  return wrench;
}

}  // namespace sim
