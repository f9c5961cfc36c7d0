#include "world/urdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "world/repairs.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

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
  const pugi::xml_node safety = joint.child("safety_controller");
  if (safety && !safety.attribute("k_velocity")) return "<safety_controller> of " + who + " has no k_velocity";
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

// Attributes that are numbers, by their element.
struct NumberAttributes {
  std::string_view element;
  std::size_t count;
  std::vector<const char*> names;
};

Fault wrong_number(pugi::xml_node node, const std::string& who) {
  static const std::array<NumberAttributes, 12> known = {{
      {"origin", 3, {"xyz", "rpy"}},
      {"axis", 3, {"xyz"}},
      {"mass", 1, {"value"}},
      {"inertia", 1, {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}},
      {"limit", 1, {"lower", "upper", "effort", "velocity"}},
      {"dynamics", 1, {"damping", "friction"}},
      {"safety_controller", 1, {"soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"}},
      {"calibration", 1, {"rising", "falling"}},
      {"box", 3, {"size"}},
      {"cylinder", 1, {"radius", "length"}},
      {"sphere", 1, {"radius"}},
      {"mesh", 3, {"scale"}},
  }};
  for (const NumberAttributes& row : known) {
    if (row.element != node.name()) continue;
    for (const char* name : row.names) {
      const pugi::xml_attribute attribute = node.attribute(name);
      const std::vector<std::string> words = base::split_list(attribute.value(), ' ');
      const bool are_numbers = std::ranges::all_of(words, [](const std::string& word) { return base::parse_number(word).has_value(); });
      if (!attribute || (are_numbers && words.size() == row.count)) continue;
      return std::string(name) + " of <" + node.name() + "> of " + who + " must be " + (row.count == 1 ? "a number" : "three numbers") +
             ", got " + base::in_quotes(attribute.value());
    }
  }
  for (const pugi::xml_node child : node.children()) {
    if (Fault fault = wrong_number(child, who)) return fault;
  }
  return {};
}

// --- what the library translates wrongly

using Nodes = std::map<std::string, pugi::xml_node, std::less<>>;

std::string_view parent_of(pugi::xml_node joint) { return joint.child("parent").attribute("link").value(); }
std::string_view child_of(pugi::xml_node joint) { return joint.child("child").attribute("link").value(); }
bool is_fixed(pugi::xml_node joint) { return std::string_view(joint.attribute("type").value()) == "fixed"; }

bool is_massless(pugi::xml_node link) {
  const pugi::xml_attribute mass = link.child("inertial").child("mass").attribute("value");
  return base::parse_number(mass.value()).value_or(0) == 0;
}

Eigen::Isometry3d origin_of(pugi::xml_node joint) {
  const pugi::xml_node origin = joint.child("origin");
  pugi::xml_document scratch;
  pugi::xml_node pose = scratch.append_child("pose");
  const auto words = [&](const char* key) { return std::string(origin.attribute(key) ? origin.attribute(key).value() : "0 0 0"); };
  pose.text() = (words("xyz") + " " + words("rpy")).c_str();
  return parse_pose(pose).value_or(Eigen::Isometry3d::Identity());
}

void set_origin(pugi::xml_node joint, const Eigen::Isometry3d& pose) {
  const std::vector<std::string> words = base::split_list(pose_text(pose), ' ');
  pugi::xml_node origin = joint.child("origin") ? joint.child("origin") : joint.append_child("origin");
  for (const char* key : {"xyz", "rpy"}) origin.remove_attribute(key);
  origin.append_attribute("xyz") = (words[0] + " " + words[1] + " " + words[2]).c_str();
  origin.append_attribute("rpy") = (words[3] + " " + words[4] + " " + words[5]).c_str();
}

// Joints that move a link hang on what holds a massless link: the library leaves out such a link with everything on it. `holders`: joints,
// by the link that is their child.
void hang_below_frames(pugi::xml_node robot, const Nodes& links, const Nodes& holders) {
  for (pugi::xml_node joint : robot.children("joint")) {
    if (is_fixed(joint)) continue;
    for (std::size_t hops = 0; hops < holders.size(); ++hops) {
      const auto holder = holders.find(parent_of(joint)), link = links.find(parent_of(joint));
      if (holder == holders.end() || link == links.end() || !is_fixed(holder->second) || !is_massless(link->second)) break;
      set_origin(joint, origin_of(holder->second) * origin_of(joint));
      joint.child("parent").attribute("link") = std::string(parent_of(holder->second)).c_str();
    }
  }
}

// With what fixed joints hold on them.
std::set<std::string, std::less<>> links_with_mass(pugi::xml_node robot) {
  std::set<std::string, std::less<>> heavy;
  for (const pugi::xml_node link : robot.children("link")) {
    if (!is_massless(link)) heavy.emplace(urdf_name(link));
  }
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (const pugi::xml_node joint : robot.children("joint")) {
      if (is_fixed(joint) && heavy.contains(child_of(joint))) has_grown = heavy.emplace(parent_of(joint)).second || has_grown;
    }
  }
  return heavy;
}

// What is wrong with the shape of a collision or visual.
Fault wrong_shape(pugi::xml_node part, const std::string& who) {
  static const std::map<std::string_view, std::vector<const char*>> needed = {
      {"box", {"size"}}, {"cylinder", {"radius", "length"}}, {"sphere", {"radius"}}, {"mesh", {"filename"}}};
  const pugi::xml_node shape = part.child("geometry").find_child([](pugi::xml_node node) { return node.type() == pugi::node_element; });
  if (!shape) return "the " + std::string(part.name()) + " of " + who + " has no shape";
  const auto known = needed.find(shape.name());
  if (known == needed.end()) return "the " + std::string(part.name()) + " of " + who + " has the unknown shape <" + shape.name() + ">";
  for (const char* key : known->second)
    if (!shape.attribute(key)) return "<" + std::string(shape.name()) + "> of " + who + " has no " + key;
  return wrong_number(shape, who);
}

// The library passes over them without a word.
void drop_wrong_shapes(pugi::xml_node robot, Complaints& complaints) {
  for (pugi::xml_node link : robot.children("link")) {
    for (const char* kind : {"collision", "visual"}) {
      for (pugi::xml_node part = link.child(kind), next; part; part = next) {
        next = part.next_sibling(kind);
        const Fault fault = wrong_shape(part, "link " + base::in_quotes(urdf_name(link)));
        if (!fault) continue;
        complaints.drop(part, *fault + "; the " + kind + " is left out");
        link.remove_child(part);
      }
    }
  }
}

// The library passes over such an <inertial> without a word. Returns the links that had one.
std::set<std::string, std::less<>> drop_wrong_masses(pugi::xml_node robot, Complaints& complaints) {
  std::set<std::string, std::less<>> links;
  for (pugi::xml_node link : robot.children("link")) {
    const Fault fault = wrong_number(link.child("inertial"), "link " + base::in_quotes(urdf_name(link)));
    if (!fault) continue;
    complaints.warn(link, *fault + "; its <inertial> is ignored");
    link.remove_child("inertial");
    links.emplace(urdf_name(link));
  }
  return links;
}

// Links that move and weigh nothing get the mass of a small ball: the library leaves them out with everything on them. `told`: those that
// have had a line.
void give_mass(pugi::xml_node robot, const Nodes& holders, const std::set<std::string, std::less<>>& told, Complaints& complaints) {
  const auto heavy = links_with_mass(robot);
  std::vector<pugi::xml_node> given;
  for (pugi::xml_node link : robot.children("link")) {
    const auto holder = holders.find(urdf_name(link));
    const bool moves = holder == holders.end() ? urdf_name(link) != "world" : !is_fixed(holder->second);
    if (!moves || heavy.contains(urdf_name(link))) continue;
    link.remove_child("inertial");
    pugi::xml_node inertial = link.append_child("inertial"), inertia = inertial.append_child("inertia");
    inertial.append_child("mass").append_attribute("value") = "0.1";
    for (const char* key : {"ixx", "iyy", "izz"}) inertia.append_attribute(key) = "1e-4";
    for (const char* key : {"ixy", "ixz", "iyz"}) inertia.append_attribute(key) = "0";
    if (!told.contains(urdf_name(link))) given.push_back(link);
  }
  if (given.empty()) return;
  const std::size_t more = given.size() - 1;
  const std::string others = more == 0   ? " has"
                             : more == 1 ? " and another link have"
                                         : " and " + std::to_string(more) + " other links have";
  complaints.warn(given.front(), "link " + base::in_quotes(urdf_name(given.front())) + others + " no mass; 0.1 kg is taken" +
                                     (more > 0 ? " for each" : ""));
}

constexpr double least_mass = 2e-6;  // [kg] The library takes less for nothing, and leaves out the link with everything on it.

void raise_small_masses(pugi::xml_node robot, Complaints& complaints) {
  for (pugi::xml_node link : robot.children("link")) {
    pugi::xml_attribute mass = link.child("inertial").child("mass").attribute("value");
    const double value = base::parse_number(mass.value()).value_or(0);
    if (!(value > 0 && value < least_mass)) continue;
    complaints.warn(link, "link " + base::in_quotes(urdf_name(link)) + " has a mass of " + base::format_number(value) + " kg; " +
                              base::format_number(least_mass) + " kg, the least, is taken");
    mass = base::format_number(least_mass).c_str();
  }
}

bool has_direction(pugi::xml_node axis) {
  const auto xyz = parse_numbers(axis.attribute("xyz").value());
  return xyz && xyz->size() == 3 && std::hypot((*xyz)[0], (*xyz)[1], (*xyz)[2]) > 1e-9;
}

// Numbers of joints that the library passes over, or makes several errors of.
void replace_impossible_numbers(pugi::xml_node robot, Complaints& complaints) {
  for (const pugi::xml_node joint : robot.children("joint")) {
    const std::string who = "joint " + base::in_quotes(urdf_name(joint));
    if (pugi::xml_node axis = joint.child("axis"); axis && !is_fixed(joint) && !has_direction(axis)) {
      complaints.warn(joint, "xyz of <axis> of " + who + " must be three numbers that are not all zero, got " +
                                 base::in_quotes(axis.attribute("xyz").value()) + "; 1 0 0 is taken");
      axis.remove_attribute("xyz");
      axis.append_attribute("xyz") = "1 0 0";
    }
    pugi::xml_attribute lower = joint.child("limit").attribute("lower"), upper = joint.child("limit").attribute("upper");
    const double least = base::parse_number(lower.value()).value_or(0), most = base::parse_number(upper.value()).value_or(0);
    if (lower && upper && least > most) {
      complaints.warn(joint, "lower and upper of <limit> of " + who + " must ascend, got " + base::format_number(least) + " and " +
                                 base::format_number(most) + "; they are exchanged");
      const std::string text = lower.value();
      lower = upper.value();
      upper = text.c_str();
    }
    for (const char* key : {"effort", "velocity"}) {
      pugi::xml_attribute limit = joint.child("limit").attribute(key);
      if (base::parse_number(limit.value()).value_or(0) >= 0) continue;
      complaints.warn(joint,
                      std::string(key) + " of <limit> of " + who + " must not be negative, got " + limit.value() + "; it is not limited");
      limit = "1e16";
    }
  }
}

// The library reads no infinities.
void bound_limits(pugi::xml_node robot) {
  for (const pugi::xml_node joint : robot.children("joint")) {
    for (pugi::xml_attribute attribute : joint.child("limit").attributes()) {
      const auto value = parse_numbers(attribute.value());
      if (value && value->size() == 1 && std::isinf(value->front())) attribute = value->front() > 0 ? "1e16" : "-1e16";
    }
  }
}

}  // namespace

std::string urdf_for_library(pugi::xml_node written, Complaints& complaints) {
  pugi::xml_document document;
  const pugi::xml_node robot = document.append_copy(written);
  Nodes links, holders;
  for (const pugi::xml_node link : robot.children("link")) links.emplace(urdf_name(link), link);
  for (const pugi::xml_node joint : robot.children("joint")) holders.emplace(child_of(joint), joint);
  drop_wrong_shapes(robot, complaints);
  const auto told = drop_wrong_masses(robot, complaints);
  raise_small_masses(robot, complaints);
  replace_impossible_numbers(robot, complaints);
  hang_below_frames(robot, links, holders);
  give_mass(robot, holders, told, complaints);
  bound_limits(robot);
  for (pugi::xml_node joint : robot.children("joint")) {
    joint.remove_child("mimic");  // carry_mimics() reads what was written
    // The library divides by the mass of such a link and what it hangs on.
    const auto link = links.find(child_of(joint));
    if (is_fixed(joint) && link != links.end() && is_massless(link->second)) link->second.remove_child("inertial");
  }
  return to_xml(robot, false);
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
      const pugi::xml_attribute text = mimic.attribute(key);
      return text ? number_of_mimic(sdf, own, key, text.value(), otherwise, complaints) : otherwise;
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
  for (const pugi::xml_node node : robot.children()) {
    const std::string_view kind = node.name();
    if (kind != "link" && kind != "joint") continue;
    if (Fault fault = wrong_number(node, std::string(kind) + " " + base::in_quotes(urdf_name(node)))) return fault;
  }
  return {};
}

}  // namespace sim
