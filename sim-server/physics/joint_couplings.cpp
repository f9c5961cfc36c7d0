// Screws and gearboxes: joints that tie the motions of two bodies, for which ODE has no joint of its own; see Coupling.
#include <algorithm>
#include <cmath>

#include "physics/joint_frames.h"
#include "physics/joints.h"

namespace sim {
namespace {

// A thread whose nut hardly moves is a hinge.
constexpr double least_lead = 1e-7;  // [m/rad]

Eigen::Vector3d across(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d other = std::abs(axis.x()) < 0.6 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  return axis.cross(other).normalized();
}

// One row that keeps both bodies' velocities along `line` at `place` apart by `rate`, whichever way the force must go: the friction of a
// contact without a force, since its bodies may come near each other as fast as they like.
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

}  // namespace

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
