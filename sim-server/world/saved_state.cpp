#include "world/saved_state.h"

#include <algorithm>
#include <string_view>

#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {
namespace {

// How a saved state calls this child of the world.
std::string called_name(pugi::xml_node entity) {
  if (std::string_view(entity.name()) != "include") return entity.attribute("name").value();
  if (std::string given = text_of(entity.child("name")); !given.empty()) return given;
  const std::string uri = text_of(entity.child("uri"));
  return uri.substr(uri.rfind('/') + 1);  // from the start when there is no slash
}

// Whether a saved state speaks of this child of the world.
bool is_called(pugi::xml_node entity, std::string_view kind, std::string_view name) {
  const std::string_view own_kind = entity.name();
  return (own_kind == "include" || own_kind == kind) && name == called_name(entity);
}

}  // namespace

// Files that Gazebo classic saved hold the models as they were made and, apart from them, what was added, taken away and moved since.
void SavedState::apply(pugi::xml_node world) {
  for (pugi::xml_node state = world.child("state"); state; state = world.child("state")) {
    for (pugi::xml_node added : state.child("insertions").children()) world.append_copy(added);
    for (pugi::xml_node removed : state.child("deletions").children("name")) {
      const std::string name = text_of(removed);
      for (pugi::xml_node entity = world.first_child(), next; entity; entity = next) {
        next = entity.next_sibling();
        if (is_called(entity, "model", name) || is_called(entity, "light", name)) world.remove_child(entity);
      }
    }
    std::multimap<std::string, pugi::xml_node> called;
    for (pugi::xml_node entity : world.children()) called.emplace(called_name(entity), entity);
    for (pugi::xml_node saved : state.children()) {
      const std::string_view kind = saved.name();
      const pugi::xml_node pose = saved.child("pose");
      if ((kind != "model" && kind != "light") || !pose || !parse_pose(pose)) continue;
      const auto [first, last] = called.equal_range(saved.attribute("name").value());
      for (auto entry = first; entry != last; ++entry) {
        pugi::xml_node entity = entry->second;
        if (!is_called(entity, kind, entry->first)) continue;
        entity.remove_child("pose");
        pugi::xml_node moved = entity.append_copy(pose);
        moved.remove_attribute("relative_to");
      }
      if (kind == "model") collect_links(saved, saved.attribute("name").value(), {});
    }
    world.remove_child(state);
  }
}

// Links of a state have their poses and velocities in the world.
void SavedState::collect_links(pugi::xml_node saved, const std::string& model, const std::string& scope) {
  const auto named = [&](pugi::xml_node node) { return (scope.empty() ? "" : scope + "::") + node.attribute("name").value(); };
  for (pugi::xml_node link : saved.children("link")) {
    Link out{named(link), parse_pose(link.child("pose")), {}, {}};
    const auto velocity = parse_numbers(text_of(link.child("velocity")));
    if (velocity && velocity->size() == 6) {
      out.linear = Eigen::Vector3d(velocity->data());
      out.angular = Eigen::Vector3d(velocity->data() + 3);
    }
    const bool is_usable = (!out.pose || out.pose->matrix().allFinite()) && out.linear.allFinite() && out.angular.allFinite() &&
                           (!out.pose || out.pose->translation().cwiseAbs().maxCoeff() < 1e9) && out.linear.cwiseAbs().maxCoeff() < 1000 &&
                           out.angular.cwiseAbs().maxCoeff() < 1000;
    if (is_usable) links_.emplace(model, std::move(out));
  }
  for (pugi::xml_node inner : saved.children("model")) collect_links(inner, model, named(inner));
}

void SavedState::move(ModelDef& model) const {
  const auto [first, last] = links_.equal_range(model.name);
  for (auto entry = first; entry != last; ++entry) {
    const Link& saved = entry->second;
    const auto link = std::find_if(model.links.begin(), model.links.end(), [&](const LinkDef& l) { return l.name == saved.link; });
    if (link == model.links.end()) continue;
    if (saved.pose) {
      const Eigen::Isometry3d place = model.pose.inverse() * *saved.pose;
      if (!place.isApprox(link->pose, 1e-6)) link->start_pose = place;
    }
    link->start_linear = saved.linear;
    link->start_angular = saved.angular;
  }
}

}  // namespace sim
