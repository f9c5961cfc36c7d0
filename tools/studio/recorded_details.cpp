#include "studio/recorded_details.h"

#include <algorithm>
#include <filesystem>

#include "base/text.h"

namespace studio {

using base::Error;
using base::Result;

namespace {

const Json& component_at(const RecordingFacts& facts, const std::string& path) {
  static const Json nothing;
  const auto found = std::ranges::find_if(facts.components, [&](const Json& one) { return one.value("path", "") == path; });
  return found == facts.components.end() ? nothing : *found;
}

std::string value_in(const tools::SavedComponent& component, const char* set_id, const std::string& name) {
  for (const auto& set : component.configuration_sets) {
    if (set.id != set_id) continue;
    for (const auto& [key, value] : set.values) {
      if (key == name) return value;
    }
  }
  return {};
}

}  // namespace

Json recorded_hello(const RecordingFacts& facts) {
  return {{"op", "hello"},
          {"version", RTMSIM_VERSION},
          {"read_only", true},
          {"name_server", ""},
          {"server_id", 0},
          {"recording",
           {{"file", std::filesystem::path(facts.file).filename().string()},
            {"from", facts.seconds(facts.from)},
            {"to", facts.seconds(facts.to)},
            {"step", recorded_step_s},
            {"damage", facts.damage},
            {"states", facts.states},
            {"lines", facts.lines},
            {"lines_left_out", facts.lines_left_out}}}};
}

Json recorded_system(const RecordingFacts& facts) {
  return {
      {"op", "system"},           {"revision", 1}, {"problem", ""}, {"components", facts.components}, {"connections", facts.connections},
      {"managers", Json::array()}};
}

Json recorded_world(const RecordingFacts& facts, const RecordedScene* scene, const std::string& problem) {
  const bool is_coming = scene == nullptr && problem.empty();
  return {{"op", "world"},
          {"present", scene != nullptr},
          {"problem", is_coming ? "the world is being made from the recording" : problem},
          {"is_coming", is_coming},
          {"server_id", 0},
          {"name", facts.world.empty() ? std::filesystem::path(facts.file).stem().string() : facts.world},
          {"file", facts.file},
          {"version", scene != nullptr ? scene->version : 0},
          {"links", scene != nullptr ? scene->links.size() : 0},
          {"models", scene != nullptr ? scene->models : Json::array()},
          {"ifaces", facts.ifaces}};
}

Result<Json> recorded_details(const RecordingFacts& facts, const std::string& path, Playhead& playhead) {
  const Json& component = component_at(facts, path);
  if (component.is_null()) return Error{"component " + base::in_quotes(path) + ": is not in the recording"};
  const auto now = playhead.parameters(component.value("instance", ""));
  if (!now) return now.error();
  Json json = component;
  json["properties"] = Json::object();
  json["sets"] = Json::array();
  const auto saved = facts.saved.find(path);
  if (saved == facts.saved.end()) {
    Json values = Json::array();
    for (const auto& [name, value] : *now)
      values.push_back({{"name", name}, {"value", value}, {"type", ""}, {"widget", ""}, {"constraint", ""}});
    if (!values.empty()) json["sets"].push_back({{"id", "default"}, {"active", true}, {"values", std::move(values)}});
    return json;
  }
  for (const auto& set : saved->second.configuration_sets) {
    if (set.is_hidden()) continue;
    const bool is_active = set.id == saved->second.active_set;
    Json values = Json::array();
    for (const auto& [name, value] : set.values) {
      values.push_back({{"name", name},
                        {"value", is_active && now->contains(name) ? now->at(name) : value},
                        {"type", value_in(saved->second, "__type__", name)},
                        {"widget", value_in(saved->second, "__widget__", name)},
                        {"constraint", value_in(saved->second, "__constraints__", name)}});
    }
    json["sets"].push_back({{"id", set.id}, {"active", is_active}, {"values", std::move(values)}});
  }
  return json;
}

}  // namespace studio
