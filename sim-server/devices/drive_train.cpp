#include "devices/drive_train.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sim {

void add_joints(const ModelDef& model, const PluginDef& plugin, std::initializer_list<std::string_view> spellings,
                std::vector<std::uint32_t>& joints, std::string& missing) {
  for (const auto& child : plugin.parameters.children) {
    if (std::find(spellings.begin(), spellings.end(), child.name) == spellings.end()) continue;
    if (const auto joint = joint_of(model, plugin.scope, child.text)) {
      // Models that serve several simulators name the same joint in several spellings.
      if (std::find(joints.begin(), joints.end(), *joint) == joints.end()) joints.push_back(*joint);
    } else {
      missing = child.text;
    }
  }
}

double wheel_radius(const ModelDef& model, std::uint32_t joint) {
  const LinkDef* wheel = model.link(model.joints[joint].child);
  if (wheel == nullptr) return 0;
  for (const auto& collision : wheel->collisions) {
    if (const auto* sphere = std::get_if<SphereShape>(&collision.geometry)) return sphere->radius;
    if (const auto* cylinder = std::get_if<CylinderShape>(&collision.geometry)) return cylinder->radius;
  }
  return 0;
}

double torque_of(const ModelDef& model, std::uint32_t joint) {
  if (model.joints[joint].axes.empty()) return strongest_torque;
  const double effort = model.joints[joint].axes[0].effort;
  return effort > 0 ? std::min(strongest_torque, effort) : strongest_torque;
}

bool is_of_gz_sim(const PluginDef& plugin) {
  return plugin.name.find("::systems::") != std::string::npos || plugin.filename.find("gz-sim") != std::string::npos ||
         plugin.filename.find("ignition-gazebo") != std::string::npos;
}

}  // namespace sim
