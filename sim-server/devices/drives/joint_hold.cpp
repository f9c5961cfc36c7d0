#include "devices/drives/joint_hold.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text.h"
#include "devices/angle.h"
#include "devices/drives/drive_train.h"
#include "devices/joints/joint_list.h"
#include "world/plugin_kind.h"
#include "world/xml_values.h"

namespace sim {
namespace {

constexpr double gain = 10;           // [1/s]: velocity for each unit that is missing
constexpr double hardly_any = 1e-4;   // [rad] or [m]: not worth keeping a model awake for
constexpr double usual_velocity = 2;  // [rad/s] or [m/s] towards a target

bool is_driveable(const JointDef& joint) {
  return joint.axes.size() == 1 && joint.kind != JointDef::Kind::fixed && joint.kind != JointDef::Kind::ball &&
         joint.kind != JointDef::Kind::gearbox;
}

JointHold hold_of(const ModelDef& model, ModelId id, std::uint32_t joint) {
  const AxisDef& axis = model.joints[joint].axes[0];
  JointHold hold{{id, joint}};
  // A limit may lie on the shortest way.
  const bool has_limits = std::isfinite(axis.lower) || std::isfinite(axis.upper);
  hold.turns =
      model.joints[joint].kind == JointDef::Kind::continuous || (model.joints[joint].kind == JointDef::Kind::revolute && !has_limits);
  hold.target = axis.initial_position;
  hold.most = std::isfinite(axis.velocity) && axis.velocity > 0 ? axis.velocity : usual_velocity;
  hold.effort = torque_of(model, joint);
  return hold;
}

std::vector<double> numbers_of(const ParameterNode& parameters, std::string_view name) {
  std::vector<double> numbers;
  for (const ParameterNode& child : parameters.children) {
    if (child.name != name) continue;
    for (const double number : parse_numbers(child.text).value_or(std::vector<double>{})) numbers.push_back(number);
  }
  return numbers;
}

double within_limits(const JointDef& joint, double target, const PluginDef& plugin, std::vector<std::string>& left_out) {
  const AxisDef& axis = joint.axes[0];
  const double within = std::clamp(target, axis.lower, std::max(axis.lower, axis.upper));
  if (within != target)
    left_out.push_back(fmt::format("{}: plugin {}: the initial position of joint {} must be within {:g} and {:g}, got {:g}; {:g} is taken",
                                   plugin.source, plugin.name, joint.name, axis.lower, axis.upper, target, within));
  return within;
}

// The joints that the plugin names; those of arms (with limits on both sides) for one that names none.
std::vector<std::uint32_t> joints_of(const ModelDef& model, const PluginDef& plugin, std::string& missing) {
  std::vector<std::uint32_t> joints;
  add_joints(model, plugin, {"joint_name", "joint"}, joints, missing);
  if (!joints.empty() || !missing.empty()) return joints;
  for (std::uint32_t j = 0; j < model.joints.size(); ++j) {
    const JointDef& joint = model.joints[j];
    if (joint.scope == plugin.scope && is_driveable(joint) && std::isfinite(joint.axes[0].lower) && std::isfinite(joint.axes[0].upper))
      joints.push_back(j);
  }
  return joints;
}

// The plugin that drives the joint before this controller; empty: none.
std::string other_of(const ModelDef& model, const PluginDef& plugin, std::uint32_t joint,
                     const std::map<std::uint32_t, std::string>& holders) {
  if (const auto holder = holders.find(joint); holder != holders.end()) return holder->second;
  for (const PluginDef& other : model.plugins) {
    if (&other == &plugin || !drives_joint(model, other, joint)) continue;
    return other.name;
  }
  return {};
}

std::string drive_line(const ModelDef& model, const PluginDef& plugin, std::uint32_t joint, const std::string& other) {
  return fmt::format("{}: plugin {} of model {}: joint {} is driven by {} already; the plugin does not hold it", plugin.source,
                     base::in_quotes(plugin.name), base::in_quotes(model.name), base::in_quotes(model.joints[joint].name),
                     base::in_quotes(other));
}

}  // namespace

void JointHold::before_step(Physics& physics) const {
  double rate = velocity;
  if (has_target) {
    double missing = target - physics.joint_state(joint).position;
    if (turns) missing = wrapped(missing);
    rate = std::abs(missing) < hardly_any ? 0 : std::clamp(gain * missing, -most, most);
  }
  physics.set_motor(joint, 0, rate, effort);
}

std::vector<JointHold> joint_holds_of(const Physics& physics, ModelId model, std::vector<std::string>& left_out) {
  std::vector<JointHold> holds;
  std::map<std::uint32_t, std::string> holders;  // joints, and the controllers that have them: who comes first
  const ModelDef& def = physics.def(model);
  for (const PluginDef& plugin : def.plugins) {
    if (kind_of(plugin) != PluginKind::joint_controller) continue;
    std::string missing;
    const auto joints = joints_of(def, plugin, missing);
    if (!missing.empty()) {
      left_out.push_back(
          fmt::format("{}: plugin {}: model {} has no joint {}", plugin.source, plugin.name, def.name, base::in_quotes(missing)));
    }
    const auto targets = numbers_of(plugin.parameters, "initial_position");
    const auto velocities = numbers_of(plugin.parameters, "initial_velocity");
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (!is_driveable(def.joints[joints[i]])) continue;
      if (const auto other = other_of(def, plugin, joints[i], holders); !other.empty()) {
        const bool is_named = plugin.parameters.child("joint_name") != nullptr || plugin.parameters.child("joint") != nullptr;
        if (is_named) left_out.push_back(drive_line(def, plugin, joints[i], other));
        continue;
      }
      JointHold hold = hold_of(def, model, joints[i]);
      if (i < targets.size()) hold.target = within_limits(def.joints[joints[i]], targets[i], plugin, left_out);
      if (i < velocities.size() && velocities[i] != 0) hold.has_target = false, hold.velocity = velocities[i];
      holders.emplace(joints[i], plugin.name);
      holds.push_back(hold);
    }
  }
  return holds;
}

}  // namespace sim
