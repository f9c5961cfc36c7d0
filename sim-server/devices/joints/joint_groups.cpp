#include "devices/joints/joint_groups.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "devices/device.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

constexpr std::size_t fewest_of_chain = 3;

// A controller that names no joints has all of its model.
bool is_controlled(const ModelDef& model, std::uint32_t joint) {
  return std::ranges::any_of(model.plugins, [&](const PluginDef& plugin) {
    if (kind_of(plugin) != PluginKind::joint_controller) return false;
    bool names_any = false;
    for (const ParameterNode& child : plugin.parameters.children) {
      if (child.name != "joint_name") continue;
      names_any = true;
      if (joint_of(model, plugin.scope, child.text) == joint) return true;
    }
    return !names_any && model.joints[joint].scope.starts_with(plugin.scope);
  });
}

bool is_driven(const ModelDef& model, std::uint32_t joint) {
  const JointDef& def = model.joints[joint];
  const double effort = def.axes[0].effort;
  return !def.mimic && ((std::isfinite(effort) && effort > 0) || is_controlled(model, joint));
}

const JointDef* joint_above(const ModelDef& model, const std::string& link) {
  const auto found = std::ranges::find(model.joints, link, &JointDef::child);
  return found == model.joints.end() ? nullptr : &*found;
}

// The first joint that moves on the way from the link to the base.
const JointDef* moving_joint_above(const ModelDef& model, std::string link) {
  for (std::size_t i = 0; i <= model.joints.size(); ++i) {  // bounds a ring
    const JointDef* joint = joint_above(model, link);
    if (joint == nullptr || joint->kind != JointDef::Kind::fixed) return joint;
    link = joint->parent;
  }
  return nullptr;
}

double uprightness(const JointDef& joint) { return std::abs((joint.pose_in_model.linear() * joint.axes[0].xyz).normalized().z()); }

std::optional<JointGroup> pan_tilt_of(const ModelDef& model, const std::vector<const JointDef*>& driven) {
  const auto is_driven_turn = [&](const JointDef* joint) {
    return joint != nullptr && joint->kind != JointDef::Kind::prismatic && std::ranges::find(driven, joint) != driven.end();
  };
  for (const LinkDef& link : model.links) {
    for (const SensorDef& sensor : link.sensors) {
      const auto* set = std::get_if<CameraSetDef>(&sensor.data);
      if (set == nullptr || set->cameras.empty()) continue;
      const JointDef* tilt = moving_joint_above(model, link.name);
      const JointDef* pan = is_driven_turn(tilt) ? moving_joint_above(model, tilt->parent) : nullptr;
      if (!is_driven_turn(pan) || moving_joint_above(model, pan->parent) != nullptr) continue;
      constexpr double upright = 0.9, level = 0.3;
      if (uprightness(*pan) > upright && uprightness(*tilt) < level)
        return JointGroup{"pan_tilt", "", {pan->name, tilt->name}, set->cameras.front().horizontal_fov};
    }
  }
  return std::nullopt;
}

bool is_chain(const ModelDef& model, const std::vector<const JointDef*>& joints) {
  for (std::size_t i = 1; i < joints.size(); ++i) {
    if (moving_joint_above(model, joints[i]->parent) != joints[i - 1]) return false;
  }
  return joints.size() >= fewest_of_chain;
}

std::vector<std::string> names_of(const std::vector<const JointDef*>& joints) {
  std::vector<std::string> names;
  for (const JointDef* joint : joints) names.push_back(joint->name);
  return names;
}

}  // namespace

std::vector<JointGroup> joint_groups(const ModelDef& model, const std::vector<std::uint32_t>& commandable) {
  std::vector<const JointDef*> driven, array;
  for (const auto joint : commandable) {
    if (is_driven(model, joint)) driven.push_back(&model.joints[joint]);
  }
  array = driven;
  std::vector<JointGroup> groups;
  for (const GripperDef& gripper : model.grippers) {
    JointGroup fingers{"gripper", gripper.name, {}, 0};
    for (const JointDef* joint : driven) {
      if (std::ranges::find(gripper.fingers, joint->child) == gripper.fingers.end() || joint->child == gripper.palm) continue;
      fingers.joints.push_back(joint->name);
      std::erase(array, joint);
    }
    if (!fingers.joints.empty()) groups.push_back(std::move(fingers));
  }
  if (is_chain(model, array)) groups.insert(groups.begin(), {"chain", "", names_of(array), 0});
  if (!array.empty()) groups.insert(groups.begin(), {"array", "", names_of(array), 0});
  if (auto head = pan_tilt_of(model, driven)) groups.push_back(std::move(*head));
  return groups;
}

}  // namespace sim
