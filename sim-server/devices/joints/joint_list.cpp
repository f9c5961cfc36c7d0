#include "devices/joints/joint_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

#include "devices/device.h"
#include "world/plugin_kind.h"
#include "world/xml_values.h"

namespace sim {
namespace {

constexpr double payload = 3;                                 // highest effort: times what gravity asks for
constexpr double least_torque = 5, least_force = 50;          // [N m], [N] of a joint without a limit in the file
constexpr double usual_speed = 2, usual_slide = 0.5;          // [rad/s], [m/s]
constexpr double perfect_speed = 1000, perfect_effort = 1e6;  // of a motor that turns as told
constexpr double least_turning = 1e-6, least_sliding = 1e-4;  // [kg m^2], [kg]: what a derived gain takes the joint to move

bool is_commandable(const JointDef& joint) {
  using Kind = JointDef::Kind;
  return joint.axes.size() == 1 && (joint.kind == Kind::revolute || joint.kind == Kind::continuous || joint.kind == Kind::prismatic);
}

bool is_drive(PluginKind kind) {
  using enum PluginKind;
  const bool has_belts = kind == tracked_vehicle || kind == track_controller;
  return (is_wheel_drive(kind) && !has_belts) || kind == velocity_control || kind == trajectory_follower || kind == unsupported_drive;
}

void add_named_joints(const ModelDef& model, const PluginDef& plugin, const ParameterNode& node, std::set<std::uint32_t>& joints) {
  if (is_steering_only(plugin) && (node.name == "left_joint" || node.name == "right_joint")) return;
  if (const auto joint = node.text.empty() ? std::nullopt : joint_of(model, plugin.scope, node.text)) joints.insert(*joint);
  for (const ParameterNode& child : node.children) add_named_joints(model, plugin, child, joints);
}

// The numbers of all children of that name, in order.
std::vector<double> values_named(const ParameterNode& parameters, std::string_view name) {
  std::vector<double> numbers;
  for (const ParameterNode& child : parameters.children) {
    if (child.name != name) continue;
    for (const double number : parse_numbers(child.text).value_or(std::vector<double>{})) numbers.push_back(number);
  }
  return numbers;
}

struct FileGains {
  JointGains gains;
  double effort = infinite;
  std::string from;
};

// gz-sim says max < min for no limit.
void set_bounds(double low, double high, double& out_low, double& out_high) {
  if (high < low) return;
  out_low = low, out_high = high;
}

// Which of the plugin's joints this one is.
std::optional<std::size_t> place_in(const ModelDef& model, const PluginDef& plugin, std::uint32_t joint) {
  std::size_t place = 0;
  for (const ParameterNode& child : plugin.parameters.children) {
    if (child.name != "joint_name") continue;
    if (joint_of(model, plugin.scope, child.text) == joint) return place;
    ++place;
  }
  return std::nullopt;
}

std::optional<FileGains> gains_in(const PluginDef& plugin, std::size_t place) {
  const bool is_trajectory = !values_named(plugin.parameters, "position_p_gain").empty();
  const std::string prefix = is_trajectory ? "position_" : "";
  const auto number = [&](const char* name, double otherwise) {
    const auto numbers = values_named(plugin.parameters, prefix + name);
    if (numbers.empty()) return otherwise;
    return is_trajectory ? (place < numbers.size() ? numbers[place] : otherwise) : numbers.front();
  };
  const double p = number("p_gain", 0);
  if (!(p > 0) || plugin.parameters.bool_of({"use_velocity_commands"}).value_or(false)) return std::nullopt;
  FileGains file;
  file.gains.p = p;
  file.gains.i = std::max(number("i_gain", 0), 0.0), file.gains.d = std::max(number("d_gain", 0), 0.0);
  set_bounds(number("i_min", 0), number("i_max", -1), file.gains.i_low, file.gains.i_high);
  double low = -infinite, high = infinite;
  set_bounds(number("cmd_min", 0), number("cmd_max", -1), low, high);
  file.effort = std::max(std::abs(low), std::abs(high));
  file.gains.offset = number("cmd_offset", 0);
  file.from = plugin.source;
  return file;
}

std::optional<FileGains> gains_beside(const ModelDef& model, std::uint32_t joint, bool is_named) {
  for (const GainsDef& one : model.gains) {
    if (one.joint == model.joints[joint].name && one.is_named == is_named)
      return FileGains{{one.p, one.i, one.d, one.i_low, one.i_high, 0}, infinite, one.source};
  }
  return std::nullopt;
}

// Those of a file that the user has named, of the model's own controllers, of the file that these name.
std::optional<FileGains> file_gains(const ModelDef& model, std::uint32_t joint) {
  if (auto found = gains_beside(model, joint, true)) return found;
  for (const PluginDef& plugin : model.plugins) {
    if (kind_of(plugin) != PluginKind::joint_controller) continue;
    const auto place = place_in(model, plugin, joint);
    if (!place) continue;
    if (auto found = gains_in(plugin, *place)) return found;
  }
  return gains_beside(model, joint, false);
}

bool has_perfect_motor(const ModelDef& model, std::uint32_t joint) {
  return std::ranges::any_of(model.plugins,
                             [&](const PluginDef& plugin) { return turns_as_told(plugin) && place_in(model, plugin, joint).has_value(); });
}

// For each of the joints the number of the one that it follows; -1: none.
std::vector<int> leaders_of(const ModelDef& model, const std::vector<std::uint32_t>& joints) {
  std::vector<int> leaders(joints.size(), -1);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto& mimic = model.joints[joints[i]].mimic;
    for (std::size_t k = 0; mimic && k < joints.size(); ++k) {
      if (k != i && model.joints[joints[k]].name == mimic->leader) leaders[i] = static_cast<int>(k);
    }
  }
  return leaders;
}

}  // namespace

std::vector<std::uint32_t> commandable_joints(const ModelDef& model) {
  if (model.is_static) return {};
  std::set<std::uint32_t> driven;
  for (const PluginDef& plugin : model.plugins) {
    if (is_drive(kind_of(plugin))) add_named_joints(model, plugin, plugin.parameters, driven);
  }
  std::vector<std::uint32_t> joints;
  for (std::uint32_t j = 0; j < model.joints.size(); ++j) {
    if (is_commandable(model.joints[j]) && !driven.contains(j)) joints.push_back(j);
  }
  return joints;
}

bool drives_joint(const ModelDef& model, const PluginDef& plugin, std::uint32_t joint) {
  if (is_propeller(kind_of(plugin)))
    return joint_of(model, plugin.scope, plugin.parameters.text_of({"joint_name", "jointName"}).value_or("")) == joint;
  std::set<std::uint32_t> joints;
  if (is_drive(kind_of(plugin))) add_named_joints(model, plugin, plugin.parameters, joints);
  return joints.contains(joint);
}

std::vector<ListedJoint> list_joints(const ModelDef& model, const std::vector<std::uint32_t>& joints, const JointDynamics& dynamics,
                                     double gravity) {
  std::vector<double> start;
  for (const auto j : joints) start.push_back(model.joints[j].axes[0].initial_position);
  std::vector<ListedJoint> list;
  const std::vector<int> leaders = leaders_of(model, joints);
  // With those that follow it.
  const auto moved_by = [&](std::size_t i) {
    double moved = dynamics.inertia(start, i) + model.joints[joints[i]].axes[0].rotor_inertia;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const double ratio = leaders[k] == static_cast<int>(i) ? model.joints[joints[k]].mimic->multiplier : 0;
      if (ratio != 0) moved += ratio * ratio * dynamics.inertia(start, k);
    }
    return moved;
  };
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointDef& def = model.joints[joints[i]];
    const AxisDef& axis = def.axes[0];
    ListedJoint listed{joints[i], {}, {}, leaders[i], def.mimic ? def.mimic->multiplier : 1};
    auto& setup = listed.setup;
    setup.slides = dynamics.body(i).slides;
    if (def.kind != JointDef::Kind::continuous) setup.low = axis.lower, setup.high = axis.upper;
    const bool has_limits = axis.upper - axis.lower < 1e6;
    const bool is_perfect = !has_limits && has_perfect_motor(model, joints[i]);
    setup.turns_as_told = is_perfect;
    setup.goes_round = !setup.slides && def.kind != JointDef::Kind::screw && setup.low == -infinite && setup.high == infinite &&
                       axis.spring_stiffness == 0;
    const double usual = is_perfect ? perfect_speed : setup.slides ? usual_slide : usual_speed;
    setup.velocity = std::isfinite(axis.velocity) && axis.velocity > 0 ? axis.velocity : usual;
    const double least = is_perfect ? perfect_effort : setup.slides ? least_force : least_torque;
    const double derived = std::max(payload * dynamics.max_gravity_effort(i, gravity), least);
    setup.effort = std::isfinite(axis.effort) && axis.effort > 0 ? axis.effort : derived;
    if (const auto file = file_gains(model, joints[i])) {
      setup.gains = file->gains;
      setup.effort = std::min(setup.effort, file->effort);
      listed.gains_from = file->from;
    } else {
      const double moved = std::max(moved_by(i), setup.slides ? least_sliding : least_turning);
      setup.gains = derived_gains(moved);
      setup.is_compensated = true;
      listed.gains_from = "derived from the masses that it moves";
    }
    list.push_back(std::move(listed));
  }
  return list;
}

}  // namespace sim
