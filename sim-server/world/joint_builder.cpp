#include "world/joint_builder.h"

#include <cmath>
#include <numbers>

#include "base/text.h"
#include "world/checks.h"
#include "world/repairs.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace {

AxisDef build_axis(pugi::xml_node node, const Eigen::Vector3d& xyz, bool is_continuous, Complaints& complaints) {
  AxisDef axis;
  axis.xyz = xyz;
  const auto unlimited = [](double value, double limit) { return std::abs(value) >= 1e15 ? limit : value; };
  axis.lower = unlimited(number_at(node, "limit/lower", -infinite), -infinite);
  axis.upper = unlimited(number_at(node, "limit/upper", infinite), infinite);
  if (is_continuous) axis.lower = -infinite, axis.upper = infinite;
  if (axis.lower > axis.upper) {
    complaints.warn(node, "limits of " + describe_in_context(node.parent()) + " must ascend, got " + base::format_number(axis.lower) +
                              " and " + base::format_number(axis.upper) + "; it moves without limits");
    axis.lower = -infinite, axis.upper = infinite;
  }
  const auto most = [&](const char* path) {
    const double value = number_at(node, path, infinite);
    if (value < 0 || value >= 1e15) return infinite;
    return value;
  };
  axis.effort = most("limit/effort");
  axis.velocity = most("limit/velocity");
  axis.initial_position = node.attribute(initial_mark).as_double();
  axis.rotor_inertia = node.attribute(rotor_mark).as_double();
  axis.damping = number_at(node, "dynamics/damping", 0);
  axis.friction = number_at(node, "dynamics/friction", 0);
  axis.spring_reference = number_at(node, "dynamics/spring_reference", 0);
  axis.spring_stiffness = number_at(node, "dynamics/spring_stiffness", 0);
  const std::optional<double> stiffness = number_at(node, "limit/stiffness"), dissipation = number_at(node, "limit/dissipation");
  if (stiffness && *stiffness > 0 && *stiffness < 1e8)
    axis.limit_stiffness = stiffness;  // 1e8 is the specification's own value: a hard stop
  if (axis.limit_stiffness && dissipation) axis.limit_dissipation = dissipation;
  return axis;
}

JointDef::Kind kind_of_joint(std::string_view type) {
  for (int i = 0; i <= static_cast<int>(JointDef::Kind::gearbox); ++i) {
    if (to_text(static_cast<JointDef::Kind>(i)) == type) return static_cast<JointDef::Kind>(i);
  }
  return JointDef::Kind::fixed;  // the type has been checked
}

void add_axes(JointDef& joint, pugi::xml_node node, const ResolvedJoint& frames, Complaints& complaints) {
  const std::size_t axes =
      joint.kind == JointDef::Kind::fixed || joint.kind == JointDef::Kind::ball                                                     ? 0
      : joint.kind == JointDef::Kind::universal || joint.kind == JointDef::Kind::revolute2 || joint.kind == JointDef::Kind::gearbox ? 2
                                                                                                                                    : 1;
  for (std::size_t i = 0; i < axes; ++i) {
    const Eigen::Vector3d xyz = i < frames.axes.size() ? frames.axes[i] : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
    joint.axes.push_back(build_axis(node.child(i == 0 ? "axis" : "axis2"), xyz, joint.kind == JointDef::Kind::continuous, complaints));
  }
  if (const pugi::xml_attribute leader = node.child("axis").attribute(mimic_mark); leader && axes == 1) {
    const auto numbers = parse_numbers(node.child("axis").attribute(mimic_numbers_mark).value()).value_or(std::vector<double>{});
    if (numbers.size() == 3) joint.mimic = MimicDef{scoped(joint.scope, leader.value()), numbers[0], numbers[1], numbers[2]};
  }
  const bool has_cross = joint.kind == JointDef::Kind::universal || joint.kind == JointDef::Kind::revolute2;
  if (has_cross && joint.axes[0].xyz.cross(joint.axes[1].xyz).norm() < 1e-3) {
    joint.axes[1].xyz = joint.axes[0].xyz.unitOrthogonal();  // ODE ends the process for such a joint
    complaints.warn(node, describe_in_context(node) + " has two parallel axes; its second one is turned square to the first");
  }
}

}  // namespace

JointDef build_joint(pugi::xml_node node, const ResolvedJoint& frames, const std::string& scope, const Eigen::Isometry3d& place,
                     const ModelDef& model, Complaints& complaints) {
  std::string own_name = node.attribute("name").value();
  if (own_name.ends_with(joint_alias_ending)) own_name.resize(own_name.size() - joint_alias_ending.size());
  JointDef joint;
  joint.name = scoped(scope, own_name);
  joint.scope = scope;
  joint.kind = kind_of_joint(node.attribute("type").value());
  if (!frames.parent.empty()) joint.parent = scoped(scope, frames.parent);
  if (!frames.child.empty()) joint.child = scoped(scope, frames.child);
  joint.pose_in_model = place * frames.pose;
  const LinkDef* child = model.link(joint.child);
  joint.pose_in_child = child ? Eigen::Isometry3d(child->pose.inverse() * joint.pose_in_model) : joint.pose_in_model;
  add_axes(joint, node, frames, complaints);
  // The element counts radians per metre, left-handed ones positive; 0 stands for a nut that does not travel.
  const double per_metre = number_at(node, "thread_pitch", -2 * std::numbers::pi);
  if (joint.kind == JointDef::Kind::screw && per_metre != 0) joint.thread_pitch = -2 * std::numbers::pi / per_metre;
  joint.gearbox_ratio = number_at(node, "gearbox_ratio", 1);
  if (const std::string reference = text_at(node, "gearbox_reference_body"); !reference.empty())
    joint.gearbox_reference = scoped(scope, reference);
  const pugi::xml_node ode = child_at(node, "physics/ode");
  joint.cfm = number_at(ode, "cfm");
  joint.erp = number_at(ode, "erp");
  joint.suspension_cfm = number_at(ode, "suspension/cfm");
  joint.suspension_erp = number_at(ode, "suspension/erp");
  joint.stop_cfm = number_at(ode, "limit/cfm");
  joint.stop_erp = number_at(ode, "limit/erp");
  joint.provide_feedback = bool_at(ode, "provide_feedback", bool_at(node, "physics/provide_feedback", false));
  return joint;
}

}  // namespace sim
