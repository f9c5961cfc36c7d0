#include "world/repairs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "world/ros_joints.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace {

// Attributes of URDF that are elements in SDFormat. An empty element name: the text of the element itself.
struct UrdfAttribute {
  std::string_view owner, attribute, element;
};
constexpr std::array<UrdfAttribute, 24> urdf_attributes{{
    {"inertia", "ixx", "ixx"},
    {"inertia", "ixy", "ixy"},
    {"inertia", "ixz", "ixz"},
    {"inertia", "iyy", "iyy"},
    {"inertia", "iyz", "iyz"},
    {"inertia", "izz", "izz"},
    {"box", "size", "size"},
    {"cylinder", "radius", "radius"},
    {"cylinder", "length", "length"},
    {"sphere", "radius", "radius"},
    {"capsule", "radius", "radius"},
    {"capsule", "length", "length"},
    {"mesh", "filename", "uri"},
    {"mesh", "scale", "scale"},
    {"mass", "value", ""},
    {"parent", "link", ""},
    {"child", "link", ""},
    {"axis", "xyz", "xyz"},
    {"limit", "lower", "lower"},
    {"limit", "upper", "upper"},
    {"limit", "effort", "effort"},
    {"limit", "velocity", "velocity"},
    {"dynamics", "damping", "damping"},
    {"dynamics", "friction", "friction"},
}};

void take_urdf_attributes(pugi::xml_node node, Complaints& complaints) {
  bool has_taken = false;
  for (const UrdfAttribute& known : urdf_attributes) {
    if (known.owner != node.name()) continue;
    const pugi::xml_attribute attribute = node.attribute(std::string(known.attribute).c_str());
    if (!attribute) continue;
    pugi::xml_node target = node;
    if (!known.element.empty()) {
      const std::string name(known.element);
      if (!node.child(name.c_str())) node.append_child(name.c_str());
      target = node.child(name.c_str());
    }
    if (!target.first_child()) target.text() = attribute.value();
    node.remove_attribute(attribute);
    has_taken = true;
  }
  if (has_taken) complaints.warn(node, describe_in_context(node) + " has attributes as in URDF; they are taken as elements");
}

void take_urdf_origin(pugi::xml_node node, Complaints& complaints) {
  const pugi::xml_node origin = node.child("origin");
  if (!origin || (!origin.attribute("xyz") && !origin.attribute("rpy"))) return;
  complaints.warn(origin, "<origin> of " + describe_in_context(node) + " is written as in URDF; it is taken as <pose>");
  if (!node.child("pose")) {
    const std::string xyz = origin.attribute("xyz").as_string("0 0 0"), rpy = origin.attribute("rpy").as_string("0 0 0");
    pugi::xml_node pose = node.insert_child_before("pose", origin);
    pose.append_copy(origin.attribute(line_mark));
    pose.text() = (xyz + " " + rpy).c_str();
  }
  node.remove_child(origin);
}

// The upper half of <fluid_added_mass>, which is newer than the version that is checked against.
void mark_added_mass(pugi::xml_node node) {
  const pugi::xml_node written = node.child("fluid_added_mass");
  if (!written || std::string_view(node.name()) != "inertial") return;
  constexpr std::string_view axes = "xyzpqr";
  std::string numbers;
  for (std::size_t row = 0; row < axes.size(); ++row) {
    for (std::size_t column = row; column < axes.size(); ++column)
      numbers += base::format_number(number_at(written, std::string{axes[row], axes[column]}, 0)) + " ";
  }
  node.append_attribute(added_mass_mark) = numbers.c_str();
  node.remove_child(written);
}

// <inertial auto="true"> and <density> are newer than the version that is checked against.
void mark_automatic_inertia(pugi::xml_node node) {
  const std::string_view name = node.name();
  if (name != "inertial" && name != "collision") return;
  if (name == "inertial" && node.attribute("auto")) {
    if (node.attribute("auto").as_bool()) node.append_attribute(automatic_mark) = true;
    node.remove_attribute("auto");
  }
  if (const pugi::xml_node density = node.child("density")) {
    node.append_attribute(density_mark) = text_of(density).c_str();
    node.remove_child("density");
  }
  node.remove_child("auto_inertia_params");
}

void mark_initial_position(pugi::xml_node node, Complaints& complaints) {
  const std::string_view name = node.name();
  const pugi::xml_node written = node.child("initial_position");
  if (!written || (name != "axis" && name != "axis2")) return;
  const std::optional<double> position = number_at(node, "initial_position");
  if (position && std::abs(*position) < 1e6) {
    node.append_attribute(initial_mark) = base::format_number(*position).c_str();
  } else {
    complaints.warn(written, "<initial_position> of " + describe_in_context(node.parent()) + " must be a number, got " +
                                 base::in_quotes(text_of(written)) + "; 0 is taken");
  }
  node.remove_child(written);
}

void take_mimic(pugi::xml_node node, Complaints& complaints) {
  const pugi::xml_node written = node.child("mimic");
  if (!written || std::string_view(node.name()) != "axis") return;
  const auto number = [&](const char* key, double otherwise) {
    const pugi::xml_node text = written.child(key);
    return text ? number_of_mimic(text, describe_in_context(node.parent()), key, text_of(text), otherwise, complaints) : otherwise;
  };
  const double multiplier = number("multiplier", 1), offset = number("offset", 0), reference = number("reference", 0);
  mark_mimic(node, written.attribute("joint").value(), multiplier, offset, reference);
  node.remove_child(written);
}

// <screw_thread_pitch> of version 1.10 [m per turn] as the older <thread_pitch> [rad per metre, left-handed positive].
void take_screw_pitch(pugi::xml_node joint) {
  const pugi::xml_node written = joint.child("screw_thread_pitch");
  const std::optional<double> pitch = number_at(joint, "screw_thread_pitch");
  if (!written) return;
  joint.remove_child("thread_pitch");
  if (pitch && *pitch != 0) {
    joint.append_child("thread_pitch").text() = base::format_number(-2 * std::numbers::pi / *pitch).c_str();
  } else if (pitch) {
    joint.append_child("thread_pitch").text() = "0";
  }
  joint.remove_child(written);
}

void make_lower_case(pugi::xml_node node, const char* key) {
  if (pugi::xml_attribute attribute = node.attribute(key)) attribute = base::to_lower(attribute.value()).c_str();
}

// Gazebo classic writes frame="" into every pose, which says nothing; libsdformat takes it for a reference where nested models were
// flattened.
void remove_empty_references(pugi::xml_node node) {
  for (const char* key : {"frame", "relative_to", "attached_to", "expressed_in"}) {
    if (const pugi::xml_attribute reference = node.attribute(key); reference && base::trim(reference.value()).empty())
      node.remove_attribute(reference);
  }
}

void repair(pugi::xml_node node, Complaints& complaints) {
  for (pugi::xml_node child = node.first_child(), next; child; child = next) {
    next = child.next_sibling();
    if (child.type() != pugi::node_element) continue;
    const std::string_view name = child.name();
    if (name == "plugin" || name == "state") continue;
    if (name.starts_with("xacro:")) {
      complaints.warn(child, "<" + std::string(name.substr(0, 60)) + "> is left over from xacro, which has not been run; it is ignored");
      node.remove_child(child);
      continue;
    }
    if (name == "joint" || name == "light") make_lower_case(child, "type");
    if (name == "joint") take_screw_pitch(child);
    remove_empty_references(child);
    take_urdf_attributes(child, complaints);
    take_urdf_origin(child, complaints);
    mark_added_mass(child);
    mark_automatic_inertia(child);
    mark_initial_position(child, complaints);
    take_mimic(child, complaints);
    repair(child, complaints);
    if (name == "model")
      carry_initial_positions(child, child, complaints), carry_mimic_plugins(child, complaints), carry_rotors(child, child, complaints);
  }
}

}  // namespace

double number_of_mimic(pugi::xml_node node, const std::string& joint, const char* key, const std::string& text, double otherwise,
                       Complaints& complaints) {
  constexpr double most = 1e6;
  const auto value = base::parse_number(text);
  if (value && std::abs(*value) <= most) return *value;
  complaints.warn(node, std::string("the ") + key + " of the <mimic> of " + joint + " must be a number up to 1e6, got " +
                            base::in_quotes(text) + "; " + base::format_number(otherwise) + " is taken");
  return otherwise;
}

void mark_mimic(pugi::xml_node axis, const std::string& leader, double multiplier, double offset, double reference) {
  axis.append_attribute(mimic_mark) = leader.c_str();
  axis.append_attribute(mimic_numbers_mark) =
      (base::format_number(multiplier) + " " + base::format_number(offset) + " " + base::format_number(reference)).c_str();
}

void repair_document(pugi::xml_node sdf, Complaints& complaints) {
  repair(sdf, complaints);
  pugi::xml_node world = sdf.child("world");
  for (pugi::xml_node joint = world.child("joint"); joint; joint = world.child("joint")) {
    complaints.drop(joint, describe(joint) + " joins models; only joints in models are simulated, and it is left out");
    world.remove_child(joint);
  }
  while (world.remove_child("audio")) {  // nothing here can hear it
  }
}

namespace {

using NewNames = std::map<std::string, std::string, std::less<>>;

void flatten_names(pugi::xml_node node, NewNames& names) {
  for (pugi::xml_node child : node.children()) {
    const std::string_view kind = child.name();
    if (kind == "plugin" || kind == "state") continue;
    flatten_names(child, names);
    pugi::xml_attribute name = child.attribute("name");
    std::string flat = name.value();
    if ((kind != "link" && kind != "joint" && kind != "frame" && kind != "model") || flat.find("::") == std::string::npos) continue;
    for (std::size_t at; (at = flat.find("::")) != std::string::npos;) flat.replace(at, 2, "_");
    names[name.value()] = flat;
    name = flat.c_str();
  }
}

constexpr std::array<const char*, 4> reference_keys{"frame", "relative_to", "attached_to", "expressed_in"};

bool has_reference_outside(pugi::xml_node node, std::string_view prefix) {
  const auto is_outside = [&](std::string_view reference) { return !reference.empty() && !reference.starts_with(prefix); };
  for (const char* key : reference_keys) {
    if (is_outside(node.attribute(key).value())) return true;
  }
  const std::string_view kind = node.name();
  if ((kind == "parent" || kind == "child") && is_outside(text_of(node))) return true;
  for (pugi::xml_node child : node.children()) {
    if (has_reference_outside(child, prefix)) return true;
  }
  return false;
}

void rename_references(pugi::xml_node node, const NewNames& names) {
  for (const char* key : reference_keys) {
    pugi::xml_attribute reference = node.attribute(key);
    if (const auto found = names.find(std::string_view(reference.value())); found != names.end()) reference = found->second.c_str();
  }
  if (const auto found = names.find(text_of(node)); found != names.end()) node.text() = found->second.c_str();
  for (pugi::xml_node child : node.children()) rename_references(child, names);
}

}  // namespace

bool has_flattened_names(pugi::xml_node node) {
  const auto is_one = [](pugi::xml_node child) {
    const std::string_view kind = child.name();
    if (kind == "plugin" || kind == "state") return false;
    return std::string_view(child.attribute("name").value()).find("::") != std::string_view::npos || has_flattened_names(child);
  };
  return std::any_of(node.begin(), node.end(), is_one);
}

void keep_axes_in_nested_models(pugi::xml_node node) {
  for (pugi::xml_node child : node.children()) {
    const std::string_view kind = child.name(), name = child.attribute("name").value();
    const std::size_t last = name.rfind("::");
    if (kind != "joint" || last == std::string_view::npos) {
      keep_axes_in_nested_models(child);
      continue;
    }
    for (const char* axis : {"axis", "axis2"}) {
      pugi::xml_attribute frame = child.child(axis).child("xyz").attribute("expressed_in");
      if (frame && std::string_view(frame.value()) == "__model__")
        frame = std::string(name.substr(0, last + 2)).append("__model__").c_str();
    }
  }
}

bool has_torn_names(pugi::xml_node node) {
  for (pugi::xml_node child : node.children()) {
    const std::string_view kind = child.name(), name = child.attribute("name").value();
    if (kind == "plugin" || kind == "state") continue;
    if (has_torn_names(child)) return true;
    const std::size_t last = name.rfind("::");
    if ((kind != "link" && kind != "joint" && kind != "frame") || last == std::string_view::npos || name.ends_with("::__model__")) continue;
    if (has_reference_outside(child, name.substr(0, last + 2))) return true;
  }
  return false;
}

bool flatten_names(pugi::xml_node sdf, Complaints& complaints) {
  NewNames names;
  flatten_names(sdf, names);
  if (names.empty()) return false;
  rename_references(sdf, names);
  complaints.warn(sdf, "names with '::' (" + base::in_quotes(names.begin()->first) +
                           " and the like) do not make nested models here; '_' is written in place of '::'");
  return true;
}

pugi::xml_node model_of_road(pugi::xml_node road, pugi::xml_node parent) {
  constexpr double thickness = 0.01;
  const double width = number_at(road, "width", 1);
  std::vector<Eigen::Vector3d> points;
  for (pugi::xml_node point : road.children("point")) {
    const std::optional<std::vector<double>> n = parse_numbers(text_of(point));
    if (n && n->size() == 3) points.emplace_back((*n)[0], (*n)[1], (*n)[2]);
  }
  pugi::xml_node model = parent.append_child("model");
  model.append_attribute("name") = road.attribute("name").value();
  model.append_child("static").text() = true;
  pugi::xml_node link = model.append_child("link");
  link.append_attribute("name") = "link";
  int count = 0;
  const pugi::xml_node material = road.child("material");
  const auto add = [&](const char* shape, const Eigen::Vector3d& middle, double pitch, double yaw) {
    pugi::xml_node visual = link.append_child("visual");
    visual.append_attribute("name") = ("strip_" + std::to_string(count++)).c_str();
    std::string pose;
    for (const double number : {middle.x(), middle.y(), middle.z() - thickness / 2, 0.0, pitch, yaw})
      pose += base::format_number(number) + " ";
    visual.append_child("pose").text() = pose.c_str();
    visual.append_child("cast_shadows").text() = false;
    if (material) visual.append_copy(material);
    return visual.append_child("geometry").append_child(shape);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    pugi::xml_node disc = add("cylinder", points[i], 0, 0);
    disc.append_child("radius").text() = base::format_number(width / 2).c_str();
    disc.append_child("length").text() = thickness;
    if (i == 0) continue;
    const Eigen::Vector3d along = points[i] - points[i - 1];
    if (along.norm() < 1e-6) continue;
    const double yaw = std::atan2(along.y(), along.x()), pitch = -std::atan2(along.z(), along.head<2>().norm());
    add("box", (points[i] + points[i - 1]) / 2, pitch, yaw).append_child("size").text() =
        (base::format_number(along.norm()) + " " + base::format_number(width) + " " + base::format_number(thickness)).c_str();
  }
  return model;
}

}  // namespace sim
