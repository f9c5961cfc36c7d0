#include "run/model_parts.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

std::string listed(const std::vector<std::string>& names) { return names.empty() ? "none" : base::join(names, ", "); }

Result<void> find_part(const std::vector<ModelParts>& parts, const std::string& model, const std::string& kind, const std::string& name,
                       std::vector<std::string> ModelParts::*names) {
  const auto found = std::ranges::find(parts, model, &ModelParts::name);
  if (found == parts.end()) return Error{"the world has no model " + base::in_quotes(model)};
  const auto& all = *found.*names;
  if (std::ranges::find(all, name) != all.end()) return {};
  return Error{"model " + base::in_quotes(model) + " has no " + kind + " " + base::in_quotes(name) + "; " + kind + "s: " + listed(all)};
}

}  // namespace

ModelParts to_parts(const nlohmann::json& model) {
  const auto none = nlohmann::json::array();
  ModelParts parts{model.value("name", ""), {}, {}};
  for (const auto& joint : model.value("joints", none)) {
    const auto type = joint.value("type", "");
    if (type != "fixed" && type != "ball") parts.joints.push_back(joint.value("name", ""));
  }
  for (const auto& link : model.value("links", none)) parts.links.push_back(link.value("name", ""));
  for (const auto& one : model.value("grippers", none)) {
    Gripper gripper{parts.name + "::" + one.value("name", ""), parts.name};
    gripper.links = one.value("fingers", std::vector<std::string>());
    const auto palm = one.value("palm", "");
    if (std::ranges::find(gripper.links, palm) == gripper.links.end()) gripper.links.push_back(palm);
    parts.grippers.push_back(std::move(gripper));
  }
  return parts;
}

std::string grip_name(const std::string& gripper, const std::string& model) { return gripper + " holds " + model; }

std::string grip_problem(const Gripper& gripper, const std::string& model, const std::vector<ModelContact>& contacts) {
  std::vector<std::string> touching;
  for (const auto& link : gripper.links) {
    const auto collisions = gripper.model + "::" + link + "::";
    const auto is_there = [&](const ModelContact& contact) {
      return contact.link.starts_with(collisions) || contact.other.starts_with(collisions);
    };
    if (std::ranges::any_of(contacts, is_there)) touching.push_back(link);
  }
  if (touching.size() >= std::min<std::size_t>(2, gripper.links.size())) return "";
  return touching.empty() ? "no link of it touches " + model + "; it has " + base::join(gripper.links, ", ")
                          : "only " + touching.front() + " touches " + model;
}

Result<Gripper> find_gripper(const std::vector<ModelParts>& parts, const std::string& name) {
  std::vector<std::string> names;
  std::vector<Gripper> meant;
  for (const auto& model : parts) {
    for (const auto& gripper : model.grippers) {
      names.push_back(gripper.name);
      if (gripper.name == name) return gripper;
      if (name == model.name || gripper.name == model.name + "::" + name) meant.push_back(gripper);
    }
  }
  if (meant.size() == 1) return meant.front();
  if (meant.empty()) return Error{"the world has no gripper " + base::in_quotes(name) + "; grippers: " + listed(names)};
  names.clear();
  for (const auto& gripper : meant) names.push_back(gripper.name);
  return Error{"gripper " + base::in_quotes(name) + " may be " + base::join(names, " or ")};
}

Result<void> find_joint(const std::vector<ModelParts>& parts, const std::string& model, const std::string& joint) {
  return find_part(parts, model, "joint", joint, &ModelParts::joints);
}

Result<void> find_link(const std::vector<ModelParts>& parts, const std::string& model, const std::string& link) {
  return find_part(parts, model, "link", link, &ModelParts::links);
}

}  // namespace tools
