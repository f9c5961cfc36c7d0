#include "world/ros_joints.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "base/text.h"
#include "world/repairs.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {
namespace {

std::string_view name_of_node(pugi::xml_node node) { return node.attribute("name").value(); }

pugi::xml_node joint_of_model(pugi::xml_node model, std::string_view name) {
  return model.find_child([&](pugi::xml_node node) { return std::string_view(node.name()) == "joint" && name_of_node(node) == name; });
}

// <param name="initial_value">, of the position's interface first; in simulated hardware of ros2_control also of the joint itself.
pugi::xml_node initial_param(pugi::xml_node joint) {
  const auto param_of = [](pugi::xml_node node) {
    for (const char* name : {"initial_value", "initial_position"}) {
      if (const pugi::xml_node param = node.find_child_by_attribute("param", "name", name)) return param;
    }
    return pugi::xml_node();
  };
  for (const char* kind : {"state_interface", "command_interface"}) {
    if (const pugi::xml_node param = param_of(joint.find_child_by_attribute(kind, "name", "position"))) return param;
  }
  return param_of(joint);
}

std::optional<double> limit_of(pugi::xml_node axis, const char* path) {
  const auto value = number_at(axis, path);
  return value && std::abs(*value) < 1e15 ? value : std::nullopt;
}

}  // namespace

void carry_initial_positions(pugi::xml_node parent, pugi::xml_node model, Complaints& complaints) {
  for (const pugi::xml_node control : parent.children("ros2_control")) {
    for (const pugi::xml_node joint : control.children("joint")) {
      const pugi::xml_node param = initial_param(joint);
      if (!param) continue;
      const std::string what = "the initial position of joint " + base::in_quotes(name_of_node(joint)) + " in <ros2_control> ";
      pugi::xml_node axis = joint_of_model(model, name_of_node(joint)).child("axis");
      const auto value = base::parse_number(text_of(param));
      if (!axis) {
        complaints.warn(model, what + "is ignored: the joint does not exist or does not move");
      } else if (!value || !(std::abs(*value) < 1e6)) {
        complaints.warn(model, what + "must be a number, got " + base::in_quotes(text_of(param)) + "; 0 is taken");
      } else if (!axis.attribute(initial_mark) && !axis.child("initial_position")) {
        const double low = limit_of(axis, "limit/lower").value_or(-std::numeric_limits<double>::infinity());
        const double high = std::max(low, limit_of(axis, "limit/upper").value_or(std::numeric_limits<double>::infinity()));
        const double within = std::clamp(*value, low, high);
        if (within != *value) {
          complaints.warn(model, what + "must be within " + base::format_number(low) + " and " + base::format_number(high) + ", got " +
                                     base::format_number(*value) + "; the nearest limit is taken");
        }
        axis.append_attribute(initial_mark) = base::format_number(within).c_str();
      }
    }
  }
}

namespace {

// The first of these elements that is there, as text or as an attribute. `otherwise` without one, and with a finding for what cannot be.
double rotor_number(pugi::xml_node node, std::initializer_list<const char*> names, double otherwise, std::string_view joint,
                    Complaints& complaints) {
  constexpr double most = 1e6;
  for (const char* name : names) {
    const pugi::xml_node element = node.child(name);
    if (!element) continue;
    const std::string text = element.attribute("value") ? element.attribute("value").value() : text_of(element);
    const auto value = base::parse_number(text);
    if (value && std::abs(*value) <= most && (*value >= 0 || otherwise != 0)) return *value;
    complaints.warn(node, std::string("<") + name + "> of joint " + base::in_quotes(joint) + " must be a number " +
                              (otherwise != 0 ? "up to 1e6" : "from 0 to 1e6") + ", got " + base::in_quotes(text) + "; " +
                              base::format_number(otherwise) + " is taken");
    return otherwise;
  }
  return otherwise;
}

void carry_rotor(pugi::xml_node written, pugi::xml_node axis, std::string_view joint, Complaints& complaints) {
  const double inertia = rotor_number(written, {"drake:rotor_inertia"}, 0, joint, complaints);
  const double ratio = rotor_number(written, {"drake:gear_ratio", "mechanicalReduction"}, 1, joint, complaints);
  if (inertia > 0 && ratio != 0 && axis && !axis.attribute(rotor_mark))
    axis.append_attribute(rotor_mark) = base::format_number(inertia * ratio * ratio).c_str();
}

}  // namespace

void carry_rotors(pugi::xml_node parent, pugi::xml_node model, Complaints& complaints) {
  for (const pugi::xml_node joint : model.children("joint")) carry_rotor(joint, joint.child("axis"), name_of_node(joint), complaints);
  for (const pugi::xml_node transmission : parent.children("transmission")) {
    const std::string_view name = name_of_node(transmission.child("joint"));
    const pugi::xml_node axis = joint_of_model(model, name).child("axis");
    for (const pugi::xml_node actuator : transmission.children("actuator")) carry_rotor(actuator, axis, name, complaints);
  }
}

void carry_mimic_plugins(pugi::xml_node model, Complaints& complaints) {
  for (const pugi::xml_node plugin : model.children("plugin")) {
    const std::string follower = text_at(plugin, "mimicJoint"), leader = text_at(plugin, "joint");
    if (follower.empty() || leader.empty()) continue;
    pugi::xml_node axis = joint_of_model(model, follower).child("axis");
    if (!axis || !joint_of_model(model, leader).child("axis")) {
      complaints.warn(plugin, "joint " + base::in_quotes(follower) + " does not mimic joint " + base::in_quotes(leader) +
                                  ": one of them does not exist or does not move");
    } else if (!axis.attribute(mimic_mark) && !axis.child("mimic")) {
      const auto number = [&](const char* key, double otherwise) {
        const pugi::xml_node text = plugin.child(key);
        return text ? number_of_mimic(text, "joint " + base::in_quotes(follower), key, text_of(text), otherwise, complaints) : otherwise;
      };
      const double multiplier = number("multiplier", 1), offset = number("offset", 0);
      mark_mimic(axis, leader, multiplier, offset, 0);
    }
  }
}

}  // namespace sim
