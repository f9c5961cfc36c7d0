#include "world/checks.h"

#include <cmath>
#include <map>
#include <set>

#include "base/text.h"
#include "world/frame_references.h"
#include "world/taken_names.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace {

constexpr std::size_t longest_name = 200;
constexpr double largest_length = 1e9;  // [m] and other physical values where a user cannot mean more

enum class Form { finite, not_negative, positive, number, vector2, positive2, vector3, positive3, scale3, direction };
enum class Remedy { drop_owner, ignore };
struct Rule {
  Form form;
  Remedy remedy;
};

const std::map<std::string_view, Rule>& rules() {
  using enum Form;
  using enum Remedy;
  static const std::map<std::string_view, Rule> table{
      {"box/size", {positive3, drop_owner}},
      {"sphere/radius", {positive, drop_owner}},
      {"cylinder/radius", {positive, drop_owner}},
      {"cylinder/length", {positive, drop_owner}},
      {"cone/radius", {positive, drop_owner}},
      {"cone/length", {positive, drop_owner}},
      {"capsule/radius", {positive, drop_owner}},
      {"capsule/length", {positive, drop_owner}},
      {"ellipsoid/radii", {positive3, drop_owner}},
      {"plane/normal", {direction, drop_owner}},
      {"plane/size", {positive2, ignore}},
      {"mesh/scale", {scale3, drop_owner}},
      {"heightmap/size", {positive3, drop_owner}},
      {"heightmap/pos", {vector3, drop_owner}},
      {"polyline/point", {vector2, drop_owner}},
      {"polyline/height", {positive, drop_owner}},
      {"axis/xyz", {direction, drop_owner}},
      {"axis2/xyz", {direction, drop_owner}},
      {"limit/lower", {number, ignore}},
      {"limit/upper", {number, ignore}},
      {"limit/effort", {number, ignore}},
      {"limit/velocity", {number, ignore}},
      {"limit/stiffness", {not_negative, ignore}},
      {"limit/dissipation", {not_negative, ignore}},
      {"dynamics/damping", {not_negative, ignore}},
      {"dynamics/friction", {not_negative, ignore}},
      {"dynamics/spring_reference", {finite, ignore}},
      {"dynamics/spring_stiffness", {finite, ignore}},
      {"joint/thread_pitch", {finite, ignore}},
      {"joint/screw_thread_pitch", {finite, ignore}},
      {"joint/gearbox_ratio", {finite, ignore}},
      {"road/width", {positive, drop_owner}},
      {"road/point", {vector3, drop_owner}},
      {"population/model_count", {positive, drop_owner}},
      {"distribution/rows", {positive, drop_owner}},
      {"distribution/cols", {positive, drop_owner}},
      {"distribution/step", {vector3, drop_owner}},
      {"world/gravity", {vector3, ignore}},
      {"atmosphere/temperature", {positive, ignore}},
      {"atmosphere/pressure", {positive, ignore}},
      {"world/magnetic_field", {vector3, ignore}},
      {"wind/linear_velocity", {vector3, ignore}},
      {"physics/max_step_size", {positive, ignore}},
      {"physics/real_time_factor", {not_negative, ignore}},
      {"sensor/update_rate", {not_negative, ignore}},
      {"range/min", {not_negative, drop_owner}},
      {"range/max", {number, drop_owner}},
      {"range/resolution", {not_negative, ignore}},
      {"horizontal/min_angle", {finite, drop_owner}},
      {"horizontal/max_angle", {finite, drop_owner}},
      {"horizontal/resolution", {positive, ignore}},
      {"vertical/min_angle", {finite, drop_owner}},
      {"vertical/max_angle", {finite, drop_owner}},
      {"vertical/resolution", {positive, ignore}},
      {"camera/horizontal_fov", {positive, drop_owner}},
      {"image/width", {positive, drop_owner}},
      {"image/height", {positive, drop_owner}},
      {"clip/near", {positive, ignore}},
      {"clip/far", {positive, ignore}},
      {"noise/mean", {finite, ignore}},
      {"noise/stddev", {not_negative, ignore}},
      {"noise/bias_mean", {finite, ignore}},
      {"noise/bias_stddev", {not_negative, ignore}},
      {"sonar/min", {not_negative, drop_owner}},
      {"sonar/max", {positive, drop_owner}},
      {"sonar/radius", {not_negative, ignore}},
      {"attenuation/range", {not_negative, ignore}},
      {"attenuation/constant", {not_negative, ignore}},
      {"attenuation/linear", {not_negative, ignore}},
      {"attenuation/quadratic", {not_negative, ignore}},
      {"light/intensity", {not_negative, ignore}},
      {"light/direction", {direction, ignore}},
      {"visual/transparency", {finite, ignore}},
      {"velocity_decay/linear", {not_negative, ignore}},
      {"velocity_decay/angular", {not_negative, ignore}},
      {"waypoint/time", {finite, drop_owner}},
      {"skin/scale", {positive, ignore}},
      {"animation/scale", {positive, ignore}},
      {"script/delay_start", {not_negative, ignore}},
  };
  return table;
}

std::string_view expectation(Form form) {
  switch (form) {
    case Form::finite:
      return "a finite number";
    case Form::not_negative:
      return "a number that is not negative";
    case Form::positive:
      return "a positive number";
    case Form::number:
      return "a number";
    case Form::vector2:
      return "two finite numbers";
    case Form::positive2:
      return "two positive numbers";
    case Form::vector3:
      return "three finite numbers";
    case Form::positive3:
      return "three positive numbers";
    case Form::scale3:
      return "three numbers other than zero";
    case Form::direction:
      return "three numbers that are not all zero";
  }
  return "a number";
}

bool is_sane(double value) { return std::isfinite(value) && std::abs(value) <= largest_length; }

bool fits(Form form, const std::string& text) {
  const std::optional<std::vector<double>> parsed = parse_numbers(text);
  if (!parsed) return false;
  const std::vector<double>& n = *parsed;
  const auto all = [&](std::size_t count, auto good) {
    if (n.size() != count) return false;
    for (double value : n) {
      if (!good(value)) return false;
    }
    return true;
  };
  const auto sane = [](double value) { return is_sane(value); };
  const auto above = [](double value) { return is_sane(value) && value > 1e-9; };
  switch (form) {
    case Form::finite:
      return all(1, sane);
    case Form::not_negative:
      return all(1, [](double value) { return std::isfinite(value) && value >= 0; });
    case Form::positive:
      return all(1, above);
    case Form::number:
      return all(1, [](double value) { return !std::isnan(value); });
    case Form::vector2:
      return all(2, sane);
    case Form::positive2:
      return all(2, above);
    case Form::vector3:
      return all(3, sane);
    case Form::positive3:
      return all(3, above);
    case Form::scale3:
      return all(3, [](double value) { return is_sane(value) && std::abs(value) > 1e-12; });
    case Form::direction:
      return all(3, sane) && std::hypot(n[0], n[1], n[2]) > 1e-9;
  }
  return false;
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  for (std::string_view candidate : names) {
    if (name == candidate) return true;
  }
  return false;
}

// The smallest object around a bad value that can be missing from a world.
pugi::xml_node owner_of(pugi::xml_node node) {
  for (pugi::xml_node at = node.parent(); at; at = at.parent()) {
    if (is_one_of(at.name(), {"collision", "visual", "sensor", "light", "joint", "frame", "waypoint", "include", "model", "actor", "gui",
                              "scene", "physics", "road", "population"}))
      return at;
  }
  return {};
}

struct NumberCheck {
  Complaints& complaints;
  std::vector<pugi::xml_node> dropped, ignored;

  void fail(pugi::xml_node node, std::string_view expected, Remedy remedy) {
    const pugi::xml_node owner = owner_of(node);
    const std::string text = "<" + std::string(node.name()) + "> of " + describe_in_context(owner ? owner : node.parent()) + " must be " +
                             std::string(expected) + ", got " + base::in_quotes(text_of(node));
    if (remedy == Remedy::drop_owner && owner) {
      complaints.drop(node, text + "; the " + owner.name() + " is left out");
      dropped.push_back(owner);
    } else {
      complaints.warn(node, text + "; it is ignored");
      ignored.push_back(node);
    }
  }

  // Three numbers where a pose is expected are a place.
  void mend_position(pugi::xml_node pose) {
    const std::optional<std::vector<double>> numbers = parse_numbers(text_of(pose));
    if (!numbers || numbers->size() != 3) return;
    const bool is_quaternion = std::string_view(pose.attribute("rotation_format").value()) == "quat_xyzw";
    complaints.warn(pose, "<pose> of " + describe_in_context(pose.parent()) + " has three numbers; it is taken without a rotation");
    pose.text() = (text_of(pose) + (is_quaternion ? " 0 0 0 1" : " 0 0 0")).c_str();
  }

  void walk(pugi::xml_node node) {
    const std::string parent = node.name();
    for (pugi::xml_node child : node.children()) {
      if (child.type() != pugi::node_element || is_one_of(child.name(), {"plugin", "state"})) continue;
      const std::string_view name = child.name();
      if (name == "pose") {
        mend_position(child);
        const std::optional<Eigen::Isometry3d> pose = parse_pose(child);
        if (!pose || pose->translation().cwiseAbs().maxCoeff() > largest_length) {
          const bool is_quaternion = std::string_view(child.attribute("rotation_format").value()) == "quat_xyzw";
          fail(child, is_quaternion ? "seven finite numbers" : "six finite numbers", Remedy::drop_owner);
        }
        continue;
      }
      const auto rule = rules().find(parent + "/" + std::string(name));
      if (rule != rules().end() && child.first_child() && !fits(rule->second.form, text_of(child))) {
        fail(child, expectation(rule->second.form), rule->second.remedy);
      }
      walk(child);
    }
  }
};

bool is_below(pugi::xml_node node, pugi::xml_node ancestor) {
  for (pugi::xml_node at = node; at; at = at.parent()) {
    if (at == ancestor) return true;
  }
  return false;
}

// Each node once, none that stands in another one of the list.
void remove_all(std::vector<pugi::xml_node> nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    bool is_covered = false;
    for (std::size_t j = 0; j < nodes.size() && !is_covered; ++j) {
      is_covered = i != j && nodes[j] && is_below(nodes[i], nodes[j]) && (nodes[i] != nodes[j] || j < i);
    }
    if (is_covered) nodes[i] = {};
  }
  for (pugi::xml_node node : nodes) {
    if (node) node.parent().remove_child(node);
  }
}

}  // namespace

bool check_numbers(pugi::xml_node entity, Complaints& complaints) {
  constexpr std::size_t most_bad_values = 2000;
  NumberCheck check{complaints, {}, {}};
  check.walk(entity);
  std::set<std::size_t> seen;
  std::vector<pugi::xml_node> once;
  for (std::vector<pugi::xml_node>* list : {&check.dropped, &check.ignored}) {
    for (pugi::xml_node node : *list) {
      if (node == entity) return false;
      if (seen.insert(node.hash_value()).second) once.push_back(node);
    }
  }
  if (once.size() > most_bad_values) {
    complaints.drop(entity, describe(entity) + " has more than " + std::to_string(most_bad_values) + " bad values and is left out");
    return false;
  }
  remove_all(std::move(once));
  return true;
}

void check_name_lengths(pugi::xml_node entity, Complaints& complaints) {
  for (pugi::xml_node child = entity.first_child(), next; child; child = next) {
    next = child.next_sibling();
    const std::size_t element = std::char_traits<char>::length(child.name());
    const std::size_t length = std::char_traits<char>::length(child.attribute("name").value());
    const bool is_named_object = !is_one_of(child.name(), {"plugin"});
    if (element > longest_name || (length > longest_name && is_named_object)) {
      const std::string what = element > longest_name ? "element name" : "name of a <" + std::string(child.name()) + ">";
      complaints.drop(child, what + " has " + std::to_string(std::max(element, length)) + " characters, at most " +
                                 std::to_string(longest_name) + " expected; the element is left out");
      entity.remove_child(child);
    } else if (std::string_view(child.name()) != "plugin") {
      check_name_lengths(child, complaints);
    }
  }
}

namespace {

std::string name_of(pugi::xml_node node) { return node.attribute("name").value(); }

bool is_reserved(const std::string& name) {
  return name == "world" || (name.size() >= 4 && name.starts_with("__") && name.ends_with("__"));
}

void rename(pugi::xml_node node, const std::string& name, const std::string& why, Complaints& complaints) {
  complaints.warn(node, describe_in_context(node) + " " + why + " and is called " + base::in_quotes(name));
  node.attribute("name") = name.c_str();
}

// References to links and frames of the model that stand directly in it (not in nested models).
template <class Visit>
void visit_references(pugi::xml_node node, const Visit& visit) {
  for (pugi::xml_node child : node.children()) {
    const std::string_view name = child.name();
    if (name == "plugin") continue;
    if (name == "pose") visit(child, child.attribute("relative_to"));
    if (name == "frame") visit(child, child.attribute("attached_to"));
    if (name == "xyz") visit(child, child.attribute("expressed_in"));
    if (name != "model") {
      visit_references(child, visit);
    } else if (const pugi::xml_node pose = child.child("pose")) {
      visit(pose, pose.attribute("relative_to"));
    }
  }
}

void rename_references(pugi::xml_node model, const std::string& from, const std::string& to) {
  visit_references(model, [&](pugi::xml_node, pugi::xml_attribute reference) {
    if (reference && from == reference.value()) reference = to.c_str();
  });
  for (pugi::xml_node joint : model.children("joint")) {
    for (const char* end : {"parent", "child"}) {
      if (text_of(joint.child(end)) == from) joint.child(end).text() = to.c_str();
    }
  }
}

void mend_names(pugi::xml_node model, Complaints& complaints) {
  TakenNames taken;
  // Joints last: when they clash with a link it is their name that nobody else refers to.
  for (const char* kind : {"link", "model", "frame", "joint"}) {
    for (pugi::xml_node node : model.children(kind)) {
      std::string name = name_of(node);
      if (name.find("::") != std::string::npos) {
        std::string plain = name;
        for (std::size_t at; (at = plain.find("::")) != std::string::npos;) plain.replace(at, 2, "_");
        rename(node, plain, "has '::' in its name", complaints);
        rename_references(model, name, plain);
        name = plain;
      }
      if (is_reserved(name)) {
        const std::string other = name == "world" ? "world_" + std::string(kind) : "reserved" + name;
        rename(node, other, "has a reserved name", complaints);
        if (std::string_view(kind) != "joint") rename_references(model, name, other);
        name = other;
      }
      if (taken.contains(name)) {
        const bool is_joint = std::string_view(kind) == "joint";
        std::string other = is_joint ? name + std::string(joint_alias_ending) : taken.free(name);
        if (!is_joint || taken.contains(other)) {
          other = taken.free(name);
          rename(node, other, "has a name that is taken", complaints);
        }
        node.attribute("name") = other.c_str();
        name = other;
      }
      taken.insert(name);
    }
  }
  for (pugi::xml_node link : model.children("link")) {
    for (const char* kind : {"collision", "visual", "sensor", "light"}) {
      TakenNames used;
      for (pugi::xml_node node : link.children(kind)) {
        const std::string name = name_of(node);
        if (used.contains(name)) rename(node, used.free(name), "has a name that is taken", complaints);
        used.insert(name_of(node));
      }
    }
  }
}

void collect_names(pugi::xml_node model, const std::string& prefix, std::set<std::string>& names) {
  names.insert(prefix + "__model__");
  for (const char* kind : {"link", "frame", "joint", "model"}) {
    for (pugi::xml_node node : model.children(kind)) {
      const std::string name = prefix + name_of(node);
      names.insert(name);
      if (std::string_view(kind) == "model") collect_names(node, name + "::", names);
    }
  }
}

// A joint whose child is the world becomes one whose parent is: the same motion about the opposite axes.
void swap_with_world(pugi::xml_node joint, const std::string& link) {
  joint.child("parent").text() = "world";
  joint.child("child").text() = link.c_str();
  pugi::xml_node pose = joint.child("pose");
  if (!pose) pose = joint.append_child("pose");
  if (!pose.attribute("relative_to")) pose.append_attribute("relative_to") = "__model__";
  for (const char* name : {"axis", "axis2"}) {
    pugi::xml_node xyz = joint.child(name).child("xyz");
    if (joint.child(name) && !xyz) (xyz = joint.child(name).append_child("xyz")).text() = "0 0 1";
    const auto numbers = parse_numbers(text_of(xyz));
    if (!numbers || numbers->size() != 3) continue;
    const std::string opposite =
        base::format_number(-(*numbers)[0]) + " " + base::format_number(-(*numbers)[1]) + " " + base::format_number(-(*numbers)[2]);
    xyz.text() = opposite.c_str();
  }
}

// Why the joint cannot be, or empty. Mends what can be mended.
std::string fault_of(pugi::xml_node joint, const std::set<std::string>& names, Complaints& complaints) {
  static const std::map<std::string_view, int> axes{{"fixed", 0}, {"ball", 0},      {"revolute", 1},  {"continuous", 1}, {"prismatic", 1},
                                                    {"screw", 1}, {"universal", 2}, {"revolute2", 2}, {"gearbox", 2}};
  const std::string type = joint.attribute("type").value();
  const auto kind = axes.find(type);
  if (kind == axes.end()) return "has the unknown type " + base::in_quotes(type);
  for (const char* end : {"parent", "child"}) {
    const std::string name = text_of(joint.child(end));
    if (name.empty()) return std::string("names no ") + end;
    if (name != "world" && !names.contains(name))
      return "has the " + std::string(end) + " " + base::in_quotes(name) + ", which does not exist";
  }
  const std::string parent = text_of(joint.child("parent")), child = text_of(joint.child("child"));
  if (parent == child) return "joins " + base::in_quotes(parent) + " to itself";
  if (child == "world") {
    swap_with_world(joint, parent);
    complaints.warn(joint, describe_in_context(joint) + " has the world as its child; parent and child are swapped" +
                               (type == "fixed" ? "" : ", its place and axes are taken in the model's frame"));
  }
  for (int i = 0; i < kind->second; ++i) {
    const char* name = i == 0 ? "axis" : "axis2";
    pugi::xml_node axis = joint.child(name);
    if (!axis) {
      axis = joint.append_child(name);
      complaints.warn(joint, describe_in_context(joint) + " has no <" + name + ">; z is taken");
    }
    if (!axis.child("xyz")) axis.append_child("xyz").text() = "0 0 1";
  }
  return {};
}

void mend_joints(pugi::xml_node model, const std::set<std::string>& names, Complaints& complaints) {
  for (pugi::xml_node joint = model.child("joint"), next; joint; joint = next) {
    next = joint.next_sibling("joint");
    const std::string fault = fault_of(joint, names, complaints);
    if (fault.empty()) continue;
    complaints.drop(joint, describe_in_context(joint) + " " + fault + "; it is left out");
    model.remove_child(joint);
  }
}

}  // namespace

bool mend_model(pugi::xml_node model, Complaints& complaints) {
  for (pugi::xml_node nested = model.child("model"), next; nested; nested = next) {
    next = nested.next_sibling("model");
    if (!mend_model(nested, complaints)) model.remove_child(nested);
  }
  const bool has_lost_include = model.remove_attribute(lost_include_mark);
  if (!model.child("link") && !model.child("model")) {
    // A model that was to hold nothing but what is not found has had its line.
    if (!has_lost_include) complaints.drop(model, describe_in_context(model) + " has no link and is left out");
    return false;
  }
  mend_names(model, complaints);
  std::set<std::string> names;
  collect_names(model, {}, names);
  mend_joints(model, names, complaints);
  names.clear();
  collect_names(model, {}, names);  // without the joints that are gone
  visit_references(model, [&](pugi::xml_node node, pugi::xml_attribute reference) {
    if (!reference || std::string_view(reference.value()).empty() || names.contains(reference.value())) return;
    if (std::string_view(node.name()) == "pose" && node.parent() == model) return;  // seen from outside the model
    complaints.warn(node, "<" + std::string(node.name()) + "> in " + describe_in_context(model) + " refers to " +
                              base::in_quotes(reference.value()) + ", which does not exist; it is ignored");
    node.remove_attribute(reference);
  });
  mend_circular_references(model, complaints);
  for (const char* key : {"canonical_link", "placement_frame"}) {
    const pugi::xml_attribute reference = model.attribute(key);
    if (reference && !std::string_view(reference.value()).empty() && !names.contains(reference.value())) {
      complaints.warn(model, "the " + std::string(key) + " " + base::in_quotes(reference.value()) + " of " + describe_in_context(model) +
                                 " does not exist; it is ignored");
      model.remove_attribute(key);
    }
  }
  return true;
}

}  // namespace sim
