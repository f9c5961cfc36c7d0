#include "physics/joints.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sim {
namespace {

using Kind = JointDef::Kind;

// A thread whose nut hardly moves is a hinge.
constexpr double least_lead = 1e-7;  // [m/rad]
constexpr double whole_turn = 2 * std::numbers::pi;
constexpr double hair = 1e-6;  // [rad] or [m] beyond a stop that is left to ODE

// The nearest number of them.
int whole_turns(double angle) { return static_cast<int>(std::lround(std::clamp(angle / whole_turn, -1e9, 1e9))); }

// The body's inertia about an axis in the world.
double inertia_about(dBodyID body, const Eigen::Vector3d& axis) {
  if (dBodyIsKinematic(body) != 0) return infinite;
  dMass mass;
  dBodyGetMass(body, &mass);
  const Eigen::Vector3d local = ode::quaternion(dBodyGetQuaternion(body)).conjugate() * axis;
  const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> inertia(mass.I);
  return local.dot(inertia.leftCols<3>() * local);
}

Eigen::Vector3d point_in(dBodyID body, const Eigen::Vector3d& point) {
  if (body == nullptr) return point;
  return ode::quaternion(dBodyGetQuaternion(body)).conjugate() * (point - ode::vector(dBodyGetPosition(body)));
}
Eigen::Vector3d direction_in(dBodyID body, const Eigen::Vector3d& direction) {
  return body == nullptr ? direction : ode::quaternion(dBodyGetQuaternion(body)).conjugate() * direction;
}
Eigen::Vector3d point_of(dBodyID body, const Eigen::Vector3d& point) {
  if (body == nullptr) return point;
  return ode::vector(dBodyGetPosition(body)) + ode::quaternion(dBodyGetQuaternion(body)) * point;
}
Eigen::Vector3d direction_of(dBodyID body, const Eigen::Vector3d& direction) {
  return body == nullptr ? direction : ode::quaternion(dBodyGetQuaternion(body)) * direction;
}

bool has_suspension(const JointDef& def) {
  if (def.suspension_cfm || def.suspension_erp) return true;
  return def.axes.size() == 2 && std::abs(def.axes[0].xyz.dot(def.axes[1].xyz)) > 1e-3;  // or axes that no cross has
}

JointSeat seat_on(dBodyID body, const Eigen::Isometry3d& frame, const Eigen::Vector3d& axis) {
  const Eigen::Quaterniond turn(frame.linear());
  return {point_in(body, frame.translation()), direction_in(body, axis),
          body == nullptr ? turn : ode::quaternion(dBodyGetQuaternion(body)).conjugate() * turn};
}

Eigen::Vector3d across(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d other = std::abs(axis.x()) < 0.6 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  return axis.cross(other).normalized();
}

// One row that keeps both bodies' velocities along `line` at `place` apart by `rate`, whichever way the force must go: the friction of a
// contact that pushes nobody, since its bodies may come near each other as fast as they like.
void tie(dWorldID world, dJointGroupID group, dBodyID a, dBodyID b, const Eigen::Vector3d& place, const Eigen::Vector3d& line,
         double rate) {
  dContact contact{};
  const Eigen::Vector3d normal = across(line);
  for (int i = 0; i < 3; ++i) {
    contact.geom.pos[i] = place[i];
    contact.geom.normal[i] = normal[i];
    contact.fdir1[i] = line[i];
  }
  contact.surface.mode = dContactMu2 | dContactFDir1 | dContactMotion1 | dContactMotionN | dContactSlip1;
  contact.surface.mu = 1e9;  // [N]; not infinite: ODE takes the first row of a joint, the push, for the infinite one
  contact.surface.mu2 = 0;
  contact.surface.slip1 = 1e-10;
  contact.surface.motion1 = rate;
  contact.surface.motionN = -1e4;
  dJointAttach(dJointCreateContact(world, group, &contact), a, b);
}

// The line of a force that turns both axes as the ratio asks: its levers about them are as -ratio. Empty for axes on one line, about which
// the levers of every force are the same.
struct Line {
  Eigen::Vector3d place, direction;
};
std::optional<Line> line_of_gear(const Coupling& at) {
  constexpr double usual_lever = 0.05;
  const Eigen::Vector3d between = at.anchor2 - at.anchor1;
  if (const Eigen::Vector3d common = at.axis1.cross(at.axis2); common.norm() > 1e-3) {
    // Across both axes. The lever about an axis is (place - anchor) . (direction x axis).
    const Eigen::Vector3d direction = common.normalized();
    Eigen::Matrix<double, 2, 3> rows;
    rows << direction.cross(at.axis1).transpose(), direction.cross(at.axis2).transpose();
    const Eigen::Vector2d wanted(usual_lever, -at.ratio * usual_lever + rows.row(1).dot(between));
    return Line{at.anchor1 + rows.transpose() * (rows * rows.transpose()).inverse() * wanted, direction};
  }
  const Eigen::Vector3d flat = between - at.axis1 * at.axis1.dot(between);
  const double distance = flat.norm(), sense = at.axis1.dot(at.axis2) < 0 ? -1 : 1;
  const double unlike = 1 + sense * at.ratio;  // the levers differ by so many times the first one
  const bool is_one_line = distance < 1e-6;
  if (is_one_line && std::abs(unlike) > 1e-9) return std::nullopt;
  const double lever = is_one_line ? usual_lever : 0.5 * distance / (1 + std::abs(at.ratio));
  // Lines that lean by an angle against the baseline have levers that differ by distance * sine.
  const Eigen::Vector3d along = is_one_line ? across(at.axis1) : (flat / distance).eval(), side = at.axis1.cross(along);
  const double sine = is_one_line ? 0 : lever * unlike / distance;
  const Eigen::Vector3d direction = along * std::sqrt(1 - sine * sine) + side * sine;
  return Line{at.anchor1 + direction.cross(at.axis1) * lever, direction};
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

void JointInstance::make_screw(dWorldID world, const Eigen::Isometry3d& frame) {
  const Eigen::Vector3d p = frame.translation(), a = frame.linear() * def_->axes[0].xyz;
  const double lead = def_->thread_pitch / (2 * std::numbers::pi);
  if (std::abs(lead) < least_lead) {
    joint_ = ode::Joint(dJointCreateHinge(world, nullptr));
    attach(joint_.id(), child_, parent_);
    dJointSetHingeAnchor(joint_.id(), p.x(), p.y(), p.z());
    dJointSetHingeAxis(joint_.id(), a.x(), a.y(), a.z());
    return;
  }
  joint_ = ode::Joint(dJointCreatePiston(world, nullptr));
  attach(joint_.id(), child_, parent_);
  dJointSetPistonAnchor(joint_.id(), p.x(), p.y(), p.z());
  dJointSetPistonAxis(joint_.id(), a.x(), a.y(), a.z());
  coupling_ = Coupling{point_in(parent_, p), direction_in(parent_, a), point_in(child_, p), direction_in(child_, a), lead, true};
}

void JointInstance::make_gearbox(const Eigen::Isometry3d& frame) {
  coupling_ = Coupling{{0, 0, 0},           direction_in(parent_, frame.linear() * def_->axes[0].xyz),
                       {0, 0, 0},           direction_in(child_, frame.linear() * def_->axes[1].xyz),
                       def_->gearbox_ratio, false};
}

void JointInstance::set_gear_anchors(const Eigen::Vector3d& parent, const Eigen::Vector3d& child) {
  coupling_->anchor1 = point_in(parent_, parent);
  coupling_->anchor2 = point_in(child_, child);
}

// --- positions, rates and efforts

bool JointInstance::turns(int) const { return dJointGetType(joint_.id()) != dJointTypeSlider; }

// One with a thread. Its place along the axis counts the turns.
bool JointInstance::is_screw() const { return dJointGetType(joint_.id()) == dJointTypePiston; }

JointState JointInstance::state(int axis) const {
  JointState now = within_turn(axis);
  if (const int turns = axis < axis_count_ ? places_[static_cast<std::size_t>(axis)].turns : 0; turns != 0)
    now.position += turns * whole_turn;
  return now;
}

// As ODE has it: an angle within half a turn.
JointState JointInstance::within_turn(int axis) const {
  const dJointID joint = joint_.id();
  if (joint == nullptr || axis >= axis_count()) return {};
  double position = 0, rate = 0;
  switch (dJointGetType(joint)) {
    case dJointTypeHinge:
      position = dJointGetHingeAngle(joint), rate = dJointGetHingeAngleRate(joint);
      break;
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

// --- limits, friction, damping, motors

void JointInstance::read_stops(int i, double dt) {
  const AxisDef& axis = def_->axes[static_cast<std::size_t>(i)];
  Stops& stops = stops_[static_cast<std::size_t>(i)];
  const auto is_limit = [&](double v) { return std::isfinite(v) && std::abs(v) <= 1e10 && def_->kind != Kind::continuous; };
  if (is_limit(axis.lower)) stops.low = axis.lower;
  if (is_limit(axis.upper)) stops.high = axis.upper;
  if (!(stops.low <= stops.high)) stops.low = -infinite, stops.high = infinite;
  stops.counts_turns = turns(i) && !is_screw() && (stops.exists() || axis.spring_stiffness != 0);
  std::optional<double> erp = def_->stop_erp, cfm = def_->stop_cfm;
  if (axis.limit_stiffness && std::isfinite(*axis.limit_stiffness)) {
    const double spring = dt * *axis.limit_stiffness, both = spring + axis.limit_dissipation.value_or(0);
    if (both > 0) erp = spring / both, cfm = 1 / both;
  }
  stops.is_soft = cfm && *cfm > 0;
  stops.erp = stops.erp_in_ode = std::clamp(erp.value_or(dWorldGetERP(world_)), 0.0, 1.0);
  if (cfm) set_stop_parameter(i, dParamStopCFM, std::clamp(*cfm, 0.0, 1e9));
  set_stop_parameter(i, dParamStopERP, stops.erp);
}

// Those of a screw hold its way.
void JointInstance::set_stop_parameter(int i, int parameter, double value) {
  is_screw() ? dJointSetPistonParam(joint_.id(), parameter, value) : set_parameter(i, parameter, value);
}

// As ODE is to have them in the next step. `rate`: of the axis now.
void JointInstance::set_stops(int i, double rate, double dt) {
  constexpr double lock_rate = 1;  // [rad/s] or [m/s] at which a joint is brought to the only place that it may have
  const Stops& stops = stops_[static_cast<std::size_t>(i)];
  const Place& place = places_[static_cast<std::size_t>(i)];
  double low = place.low, high = place.high, erp = stops.erp;
  const double way = 1.5 * rate * dt;  // forces of the step may add to it
  if (stops.is_lock()) {
    const double reach = lock_rate * dt / std::max(stops.erp, 1e-3);
    low = high = place.position + std::clamp(stops.low - place.position, -reach, reach);
    if (std::abs(stops.low - place.position) <= reach) low = high = stops.low;
  } else if (!stops.is_soft && place.position < high && place.position + way > high) {
    // It arrives at the stop in this step, and may come as far as that: a stop that has been passed by one, with the error reduction that
    // asks for the rate of the rest of the way.
    erp = place.position - high;
    low = -infinite, high = place.position - 1;
  } else if (!stops.is_soft && place.position > low && place.position + way < low) {
    erp = low - place.position;
    high = infinite, low = place.position + 1;
  }
  low -= place.turns * whole_turn, high -= place.turns * whole_turn;
  const double scale = is_screw() ? sign_ * coupling_->ratio : sign_;
  low *= scale, high *= scale;
  if (scale < 0) std::swap(low, high);
  put_stops(i, low, high, erp);
}

void JointInstance::put_stops(int i, double low, double high, double erp) {
  Stops& stops = stops_[static_cast<std::size_t>(i)];
  if (erp != stops.erp_in_ode) set_stop_parameter(i, dParamStopERP, stops.erp_in_ode = erp);
  if (low == stops.low_in_ode && high == stops.high_in_ode) return;
  stops.low_in_ode = low, stops.high_in_ode = high;
  // ODE refuses a low stop above the high one that is there, so that the low one is set again.
  set_stop_parameter(i, dParamLoStop, low);
  set_stop_parameter(i, dParamHiStop, high);
  set_stop_parameter(i, dParamLoStop, low);
}

void JointInstance::begin(double dt, bool is_saved) {
  is_followed_ = false;
  for (int i = 0; i < axis_count(); ++i) {
    const auto n = static_cast<std::size_t>(i);
    const Stops& stops = stops_[n];
    if (!stops.exists() && !stops.counts_turns) continue;
    is_followed_ = true;
    Place& place = places_[n];
    const double seen = within_turn(i).position;
    place = {seen, 0, stops.low, stops.high};
    if (stops.counts_turns) {
      place.turns = whole_turns(def_->axes[n].initial_position - seen);
      place.position += place.turns * whole_turn;
      // Of all turns those within the limits.
      const double missing = place.position < stops.low    ? std::ceil((stops.low - place.position) / whole_turn)
                             : place.position > stops.high ? std::floor((stops.high - place.position) / whole_turn)
                                                           : 0;
      const double moved = place.position + missing * whole_turn;
      if (is_saved && moved >= stops.low && moved <= stops.high) place.turns += static_cast<int>(missing), place.position = moved;
    }
    if (!stops.is_soft && !stops.is_lock()) {
      if (place.position < stops.low - hair) place.low = place.position;
      if (place.position > stops.high + hair) place.high = place.position;
    }
    set_stops(i, 0, dt);
  }
}

void JointInstance::follow(double dt) {
  for (int i = 0; i < axis_count(); ++i) {
    const Stops& stops = stops_[static_cast<std::size_t>(i)];
    if (!stops.exists() && !stops.counts_turns) continue;
    Place& place = places_[static_cast<std::size_t>(i)];
    const JointState seen = within_turn(i);
    const double before = place.position;
    if (stops.counts_turns) {
      // ODE adds a body's rate to its quaternion and makes that a unit again: so far does it turn, less than half a turn.
      place.turns = whole_turns(before + 2 * std::atan(0.5 * dt * seen.velocity) - seen.position);
    }
    place.position = seen.position + place.turns * whole_turn;
    if (!stops.is_soft && !stops.is_lock()) move_stops(i, before, dt);
    set_stops(i, seen.velocity, dt);
  }
}

// A stop that was passed is where the joint came to, and goes back slowly: ODE would give the joint a fifth of the rate at which it came.
void JointInstance::move_stops(int i, double before, double dt) {
  constexpr double back = 0.01;  // [rad/s] or [m/s]
  const Stops& stops = stops_[static_cast<std::size_t>(i)];
  Place& place = places_[static_cast<std::size_t>(i)];
  const double now = place.position;
  if (before < place.high && now > place.high + hair)
    place.high = now;
  else if (place.high > stops.high)
    place.high = std::max(stops.high, std::min(place.high - back * dt, now));
  if (before > place.low && now < place.low - hair)
    place.low = now;
  else if (place.low < stops.low)
    place.low = std::min(stops.low, std::max(place.low + back * dt, now));
}

void JointInstance::take(const Places& places, double dt) {
  places_ = places;
  for (int i = 0; i < axis_count(); ++i) {
    const Stops& stops = stops_[static_cast<std::size_t>(i)];
    if (!stops.exists() && !stops.counts_turns) continue;
    Place& place = places_[static_cast<std::size_t>(i)];
    const JointState seen = within_turn(i);
    if (stops.counts_turns) place.turns = whole_turns(place.position - seen.position);
    place.position = seen.position + place.turns * whole_turn;
    set_stops(i, seen.velocity, dt);
  }
}

bool JointInstance::has_history(int axis) const {
  const Place& place = places_[static_cast<std::size_t>(axis)];
  const Stops& stops = stops_[static_cast<std::size_t>(axis)];
  return place.turns != 0 || place.low != stops.low || place.high != stops.high;
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

// As ODE sees it in the next step.
bool JointInstance::is_at_stop() const {
  const Stops& stops = stops_[0];
  const double position = sign_ * within_turn(0).position;
  return position <= stops.low_in_ode || position >= stops.high_in_ode;
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

void JointInstance::couple(dJointGroupID step_joints, double dt) {
  Coupling now = *coupling_;
  now.anchor1 = point_of(parent_, coupling_->anchor1), now.axis1 = direction_of(parent_, coupling_->axis1);
  now.anchor2 = point_of(child_, coupling_->anchor2), now.axis2 = direction_of(child_, coupling_->axis2);
  if (!now.is_screw) {
    if (const auto line = line_of_gear(now)) tie(world_, step_joints, child_, parent_, line->place, line->direction, 0);
    return;
  }
  // A thread of some radius and its slope: what slides along it turns and rises together.
  const double radius = std::max(std::abs(now.ratio), 0.05);
  const Eigen::Vector3d out = across(now.axis2), slope = now.axis2 - now.axis2.cross(out) * (now.ratio / radius);
  const double lag =
      sign_ * std::remainder(dJointGetPistonPosition(joint_.id()) - now.ratio * dJointGetPistonAngle(joint_.id()), whole_turn * now.ratio);
  tie(world_, step_joints, child_, parent_, now.anchor2 + radius * out, slope.normalized(), -0.2 * lag / dt / slope.norm());
}

}  // namespace sim
