#include "devices/drives/drive_train.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "base/text.h"

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

base::Error drive_error(const ModelDef& model, const PluginDef& plugin, const std::string& what) {
  return base::Error{fmt::format("{}: plugin {} of model {}: {}; the plugin is left out", plugin.source, base::in_quotes(plugin.name),
                                 base::in_quotes(model.name), what)};
}

std::string size_problem(std::string_view what, double size) {
  constexpr double smallest = 0.001, largest = 1000;  // [m]
  if (size >= smallest && size <= largest) return {};
  return fmt::format("the {} must be from {} to {} m, got {}", what, smallest, largest, size);
}

namespace {

// The first ball or cylinder of the wheel that a joint turns; null: none.
const CollisionDef* tyre_of(const ModelDef& model, std::uint32_t joint) {
  const LinkDef* wheel = model.link(model.joints[joint].child);
  if (wheel == nullptr) return nullptr;
  for (const auto& collision : wheel->collisions) {
    if (std::holds_alternative<SphereShape>(collision.geometry) || std::holds_alternative<CylinderShape>(collision.geometry))
      return &collision;
  }
  return nullptr;
}

}  // namespace

double wheel_radius(const ModelDef& model, std::uint32_t joint) {
  const CollisionDef* tyre = tyre_of(model, joint);
  if (tyre == nullptr) return 0;
  const auto* sphere = std::get_if<SphereShape>(&tyre->geometry);
  return sphere != nullptr ? sphere->radius : std::get<CylinderShape>(tyre->geometry).radius;
}

Eigen::Vector3d wheel_place(const ModelDef& model, std::uint32_t joint) {
  constexpr double beside = 1e-6;  // [m]
  const JointDef& def = model.joints[joint];
  const Eigen::Vector3d place = def.pose_in_model.translation();
  const CollisionDef* tyre = tyre_of(model, joint);
  if (tyre == nullptr || def.axes.empty()) return place;
  const Eigen::Vector3d axle = (def.pose_in_model.linear() * def.axes[0].xyz).normalized();
  const Eigen::Vector3d middle = (model.link(def.child)->pose * tyre->pose).translation();
  const double along = axle.dot(middle - place), off = axle.cross(middle - place).norm();
  const bool is_on_axle = off < 0.05 * wheel_radius(model, joint);
  return is_on_axle && std::abs(along) > beside ? Eigen::Vector3d(place + along * axle) : place;
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
