#include "world/gripper_builder.h"

#include <algorithm>
#include <optional>

#include "base/text.h"
#include "world/checks.h"
#include "world/joint_builder.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {
namespace {

// In the scope first; else what is left of the name when models before it are taken off.
std::optional<std::string> link_named(const ModelDef& model, const std::string& scope, std::string name) {
  for (;;) {
    if (const auto* link = model.link(scoped(scope, name))) return link->name;
    if (const auto* link = model.link(name)) return link->name;
    const auto colons = name.find("::");
    if (colons == std::string::npos) return std::nullopt;
    name.erase(0, colons + 2);
  }
}

void add_named(pugi::xml_node node, const std::string& name, const std::string& scope, ModelDef& model, Complaints& complaints) {
  GripperDef gripper;
  gripper.name = scoped(scope, name);
  const auto link = [&](pugi::xml_node element) {
    const auto found = link_named(model, scope, text_of(element));
    if (!found)
      complaints.warn(element, describe_in_context(node) + " names the link " + base::in_quotes(text_of(element)) +
                                   ", which does not exist; it is left out");
    return found;
  };
  for (pugi::xml_node element : node.children("gripper_link")) {
    const auto found = link(element);
    if (found && std::ranges::find(gripper.fingers, *found) == gripper.fingers.end()) gripper.fingers.push_back(*found);
  }
  const bool is_twice = std::ranges::find(model.grippers, gripper.name, &GripperDef::name) != model.grippers.end();
  if (is_twice || gripper.fingers.empty()) {
    complaints.warn(node, describe_in_context(node) + (is_twice ? " has the name of another one" : " has no gripper_link that exists") +
                              "; it is ignored");
    return;
  }
  const pugi::xml_node palm = node.child("palm_link");
  gripper.palm = (palm ? link(palm) : std::nullopt).value_or(gripper.fingers.front());
  const auto count = [&](const char* path, int otherwise) {
    const int written = integer_at(node, path, otherwise), within = std::clamp(written, 1, 1'000'000);
    if (within != written)
      complaints.warn(node, std::string(path) + " of " + describe_in_context(node) + " must be from 1 to 1000000, got " +
                                std::to_string(written) + "; " + std::to_string(within) + " is taken");
    return within;
  };
  gripper.attach_checks = count("grasp_check/attach_steps", gripper.attach_checks);
  gripper.detach_checks = count("grasp_check/detach_steps", gripper.detach_checks);
  gripper.contacts = count("grasp_check/min_contact_count", gripper.contacts);
  gripper.attaches = bool_at(node, "rtmsim:attach", false);
  model.grippers.push_back(std::move(gripper));
}

}  // namespace

void add_gripper(pugi::xml_node node, const std::string& scope, ModelDef& model, Complaints& complaints) {
  add_named(node, node.attribute("name").value(), scope, model, complaints);
}

void add_grasp_fix(pugi::xml_node plugin, const std::string& scope, ModelDef& model, Complaints& complaints) {
  for (pugi::xml_node arm : plugin.children("arm")) {
    if (!arm.child("gripper_link")) continue;
    const auto palm = link_named(model, scope, text_at(arm, "palm_link"));
    const auto same = std::ranges::find_if(model.grippers, [&](const GripperDef& one) { return palm && one.palm == *palm; });
    if (same != model.grippers.end()) {
      same->attaches = true;
      continue;
    }
    const std::size_t before = model.grippers.size();
    add_named(arm, text_at(arm, "arm_name", "gripper"), scope, model, complaints);
    if (model.grippers.size() > before) model.grippers.back().attaches = true;
  }
}

}  // namespace sim
