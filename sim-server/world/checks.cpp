#include "world/checks.h"

#include <set>

#include "base/text.h"
#include "world/frame_references.h"
#include "world/number_rules.h"
#include "world/taken_names.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace {

constexpr std::size_t longest_name = 200;
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

  void fail(pugi::xml_node node, const std::string& expected, NumberRule::Remedy remedy) {
    const pugi::xml_node owner = owner_of(node);
    const std::string text = "<" + std::string(node.name()) + "> of " + describe_in_context(owner ? owner : node.parent()) + " must be " +
                             expected + ", got " + base::in_quotes(text_of(node));
    if (remedy == NumberRule::Remedy::drop_owner && owner) {
      complaints.drop(node, text + "; the " + owner.name() + " is left out");
      dropped.push_back(owner);
    } else {
      complaints.warn(node, text + "; it is ignored");
      ignored.push_back(node);
    }
  }

  // Three numbers where a pose is expected are a place.
  void repair_position(pugi::xml_node pose) {
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
        repair_position(child);
        const std::optional<Eigen::Isometry3d> pose = parse_pose(child);
        if (!pose || pose->translation().cwiseAbs().maxCoeff() > largest_length) {
          const bool is_quaternion = std::string_view(child.attribute("rotation_format").value()) == "quat_xyzw";
          fail(child, is_quaternion ? "seven finite numbers" : "six finite numbers", NumberRule::Remedy::drop_owner);
        }
        continue;
      }
      const NumberRule* rule = find_number_rule(parent, name);
      if (rule != nullptr && child.first_child() && !fits(*rule, text_of(child))) fail(child, expectation(*rule), rule->remedy);
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
  constexpr std::size_t max_bad_values = 2000;
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
  if (once.size() > max_bad_values) {
    complaints.drop(entity, describe(entity) + " has more than " + std::to_string(max_bad_values) + " bad values and is left out");
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

void repair_names(pugi::xml_node model, Complaints& complaints) {
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

// Why the joint cannot be, or empty. Repairs what can be repaired.
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

void repair_joints(pugi::xml_node model, const std::set<std::string>& names, Complaints& complaints) {
  for (pugi::xml_node joint = model.child("joint"), next; joint; joint = next) {
    next = joint.next_sibling("joint");
    const std::string fault = fault_of(joint, names, complaints);
    if (fault.empty()) continue;
    complaints.drop(joint, describe_in_context(joint) + " " + fault + "; it is left out");
    model.remove_child(joint);
  }
}

}  // namespace

bool repair_model(pugi::xml_node model, Complaints& complaints) {
  for (pugi::xml_node nested = model.child("model"), next; nested; nested = next) {
    next = nested.next_sibling("model");
    if (!repair_model(nested, complaints)) model.remove_child(nested);
  }
  const bool has_lost_include = model.remove_attribute(lost_include_mark);
  if (!model.child("link") && !model.child("model")) {
    // A model that was to hold nothing but what is not found has had its line.
    if (!has_lost_include) complaints.drop(model, describe_in_context(model) + " has no link and is left out");
    return false;
  }
  repair_names(model, complaints);
  std::set<std::string> names;
  collect_names(model, {}, names);
  repair_joints(model, names, complaints);
  names.clear();
  collect_names(model, {}, names);  // without the joints that are gone
  visit_references(model, [&](pugi::xml_node node, pugi::xml_attribute reference) {
    if (!reference || std::string_view(reference.value()).empty() || names.contains(reference.value())) return;
    if (std::string_view(node.name()) == "pose" && node.parent() == model) return;  // seen from outside the model
    complaints.warn(node, "<" + std::string(node.name()) + "> in " + describe_in_context(model) + " refers to " +
                              base::in_quotes(reference.value()) + ", which does not exist; it is ignored");
    node.remove_attribute(reference);
  });
  repair_circular_references(model, complaints);
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
