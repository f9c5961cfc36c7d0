#include "world/urdf.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "world/repairs.h"

namespace sim {
namespace {

using Fault = std::optional<std::string>;

std::string_view urdf_name(pugi::xml_node node) { return node.attribute("name").value(); }

bool is_of_xacro(pugi::xml_node node) { return std::string_view(node.name()).starts_with("xacro:"); }

Fault xacro_left(pugi::xml_node robot) {
  const pugi::xml_node found = robot.find_node(is_of_xacro);
  if (found) return "it must be expanded by xacro first, it has <" + std::string(found.name()) + ">";
  for (const pugi::xpath_node at : robot.select_nodes("//@*[contains(., '${') or contains(., '$(')]"))
    return "it must be expanded by xacro first, it has " + base::in_quotes(at.attribute().value());
  return {};
}

Fault wrong_names(pugi::xml_node robot, const char* kind) {
  std::set<std::string_view> names;
  for (const pugi::xml_node node : robot.children(kind)) {
    if (urdf_name(node).empty()) return "a <" + std::string(kind) + "> has no name";
    if (!names.insert(urdf_name(node)).second) return std::string(kind) + " " + base::in_quotes(urdf_name(node)) + " appears twice";
  }
  return {};
}

Fault wrong_limit(pugi::xml_node joint, const std::string& who) {
  const std::string_view type = joint.attribute("type").value();
  if (type != "revolute" && type != "prismatic") return {};
  const pugi::xml_node limit = joint.child("limit");
  if (!limit) return who + " is " + std::string(type) + " and has no <limit>";
  for (const char* key : {"effort", "velocity"}) {
    if (!limit.attribute(key)) return "<limit> of " + who + " has no " + key;
  }
  return {};
}

Fault wrong_joint(pugi::xml_node robot, pugi::xml_node joint) {
  constexpr std::array<std::string_view, 6> types = {"revolute", "continuous", "prismatic", "fixed", "floating", "planar"};
  const std::string who = "joint " + base::in_quotes(urdf_name(joint));
  const std::string_view type = joint.attribute("type").value();
  if (type.empty()) return who + " has no type";
  if (std::find(types.begin(), types.end(), type) == types.end()) return who + " has the unknown type " + base::in_quotes(type);
  for (const char* end : {"parent", "child"}) {
    const std::string_view link = joint.child(end).attribute("link").value();
    if (link.empty()) return who + " has no " + end;
    const auto links = robot.children("link");
    if (std::none_of(links.begin(), links.end(), [&](pugi::xml_node other) { return urdf_name(other) == link; }))
      return std::string(end) + " " + base::in_quotes(link) + " of " + who + " does not exist";
  }
  return wrong_limit(joint, who);
}

// All links must hang on one.
Fault wrong_tree(pugi::xml_node robot) {
  std::map<std::string_view, std::string_view> holders;  // joints, by the link that is their child
  for (const pugi::xml_node joint : robot.children("joint")) {
    const std::string_view child = joint.child("child").attribute("link").value();
    const auto [holder, is_new] = holders.emplace(child, urdf_name(joint));
    if (!is_new)
      return "link " + base::in_quotes(child) + " is the child of two joints, " + base::in_quotes(holder->second) + " and " +
             base::in_quotes(urdf_name(joint));
  }
  std::vector<std::string_view> roots;
  for (const pugi::xml_node link : robot.children("link")) {
    if (!holders.contains(urdf_name(link))) roots.push_back(urdf_name(link));
  }
  if (roots.empty()) return robot.child("link") ? "its links hang on each other in a ring" : "it has no link";
  if (roots.size() > 1)
    return "links " + base::in_quotes(roots[0]) + " and " + base::in_quotes(roots[1]) + " have no parent; one root is allowed";
  return {};
}

Fault without_mass(pugi::xml_node robot) {
  const auto links = robot.children("link");
  if (std::none_of(links.begin(), links.end(), [](pugi::xml_node link) { return link.select_node("inertial/mass[@value > 0]"); }))
    return "no link has a mass";
  return {};
}

}  // namespace

void mend_urdf(pugi::xml_node robot) {
  std::set<std::string_view> welded;
  for (const pugi::xml_node joint : robot.children("joint")) {
    if (std::string_view(joint.attribute("type").value()) == "fixed") welded.insert(joint.child("child").attribute("link").value());
  }
  for (pugi::xml_node link : robot.children("link")) {
    const pugi::xml_node mass = link.child("inertial").child("mass");
    const std::optional<double> value = base::parse_number(mass.attribute("value").value());
    if (value && *value == 0 && welded.contains(urdf_name(link))) link.remove_child("inertial");
  }
}

void carry_mimics(pugi::xml_node robot, pugi::xml_node sdf, Complaints& complaints) {
  const auto axis_of = [&](std::string_view name) {
    return sdf.child("model")
        .find_child([&](pugi::xml_node node) { return node.name() == std::string_view("joint") && urdf_name(node) == name; })
        .child("axis");
  };
  for (const pugi::xml_node joint : robot.children("joint")) {
    const pugi::xml_node mimic = joint.child("mimic");
    if (!mimic) continue;
    const std::string leader = mimic.attribute("joint").value();
    const std::string own = "joint " + base::in_quotes(urdf_name(joint));
    const auto number = [&](const char* key, double otherwise) {
      return number_of_mimic(sdf, own, key, mimic.attribute(key).value(), otherwise, complaints);
    };
    if (const pugi::xml_node axis = axis_of(urdf_name(joint)); axis && axis_of(leader)) {
      const double multiplier = number("multiplier", 1), offset = number("offset", 0);
      mark_mimic(axis, leader, multiplier, offset, 0);
      continue;
    }
    complaints.warn(sdf, own + " does not mimic joint " + base::in_quotes(leader) + ": one of them does not move; it moves on its own");
  }
}

std::optional<std::string> fault_of_urdf(pugi::xml_node robot) {
  if (Fault fault = xacro_left(robot)) return fault;
  if (urdf_name(robot).empty()) return "the robot has no name";
  for (const char* kind : {"link", "joint"}) {
    if (Fault fault = wrong_names(robot, kind)) return fault;
  }
  for (const pugi::xml_node joint : robot.children("joint")) {
    if (Fault fault = wrong_joint(robot, joint)) return fault;
  }
  if (Fault fault = wrong_tree(robot)) return fault;
  return without_mass(robot);
}

}  // namespace sim
