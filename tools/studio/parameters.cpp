#include "studio/parameters.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/text.h"

namespace studio {
namespace {

using base::Error;
using base::Result;

// The component whose parameter this is, and the parameter's name. Names of both can have dots; the longest instance that fits counts.
struct Place {
  std::string path, parameter;
};

std::optional<Place> place_of(const Json& system, const std::string& name) {
  std::optional<Place> place;
  std::size_t longest = 0;
  for (const Json& component : list_in(system, "components")) {
    const auto prefix = component.value("instance", "") + ".";
    if (prefix.size() <= longest || !name.starts_with(prefix)) continue;
    longest = prefix.size();
    place = Place{component.value("path", ""), name.substr(longest)};
  }
  return place;
}

Result<Json> details(const ActContext& context, const std::string& path) {
  const auto plan = find_act("component")->plan(context, {{"path", path}});
  if (!plan) return plan.error();
  return plan->run();
}

const Json* active_set(const Json& details) {
  for (const Json& set : list_in(details, "sets")) {
    if (set.value("active", false)) return &set;
  }
  return nullptr;
}

Result<void> write_set(const ActContext& context, const std::string& path, const Json& values) {
  const auto known = details(context, path);
  if (!known) return known.error();
  const Json* set = active_set(*known);
  if (set == nullptr) return Error{"component " + path + ": has no active configuration set"};
  const auto plan = find_act("set_configuration")->plan(context, {{"path", path}, {"set", set->value("id", "")}, {"values", values}});
  if (!plan) return plan.error();
  const auto done = plan->run();
  return done ? Result<void>() : Result<void>(done.error());
}

}  // namespace

Json value_from_text(const std::string& text, const std::string& type) {
  const auto number = type == "string" ? std::nullopt : base::parse_number(text);
  if (!number || !std::isfinite(*number)) return text;
  return *number;
}

Result<std::string> text_from_value(const std::string& name, const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return std::string(value.get<bool>() ? "true" : "false");
  if (value.is_number()) return base::format_number(value.get<double>());
  const Error wrong{"parameter " + base::in_quotes(name) + ": expected a number, a text, true, false, or a list of these"};
  if (!value.is_array()) return wrong;
  std::vector<std::string> texts;
  for (const Json& element : value) {
    const auto text = element.is_array() ? Result<std::string>(wrong) : text_from_value(name, element);
    if (!text) return text.error();
    texts.push_back(*text);
  }
  return base::join(texts, ",");
}

Parameters read_parameters(const ActContext& context, const Json& system, const std::vector<std::string>& names) {
  Parameters found;
  for (const Json& component : list_in(system, "components")) {
    const auto instance = component.value("instance", ""), path = component.value("path", "");
    const auto is_wanted = [&](const std::string& name) {
      const auto place = place_of(system, name);
      return place && place->path == path;
    };
    if (!component.value("problem", "").empty() || (!names.empty() && std::ranges::none_of(names, is_wanted))) continue;
    const auto known = details(context, path);
    const Json* set = known ? active_set(*known) : nullptr;
    if (set == nullptr) continue;
    for (const Json& value : list_in(*set, "values")) {
      const auto name = instance + "." + value.value("name", "");
      if (names.empty() || std::ranges::find(names, name) != names.end())
        found[name] = value_from_text(value.value("value", ""), value.value("type", ""));
    }
  }
  return found;
}

Result<void> write_parameters(const ActContext& context, const Json& system, const std::vector<std::pair<std::string, Json>>& values) {
  std::map<std::string, Json> by_path;
  std::vector<std::string> problems;
  for (const auto& [name, value] : values) {
    const auto place = place_of(system, name);
    const auto text = text_from_value(name, value);
    if (!place) problems.push_back("parameter " + base::in_quotes(name) + ": expected INSTANCE.PARAMETER of a component that runs");
    if (place && !text) problems.push_back(text.error().message);
    if (place && text) by_path[place->path][place->parameter] = *text;
  }
  for (const auto& [path, texts] : by_path) {
    if (const auto done = write_set(context, path, texts); !done) problems.push_back(done.error().message);
  }
  return problems.empty() ? Result<void>() : Result<void>(Error{base::join(problems, "; ")});
}

std::string parameter_values(const Parameters& parameters, const std::optional<std::string>& id) {
  Json list = Json::array();
  for (const auto& [name, value] : parameters) {
    Json one{{"name", name}, {"value", value}};
    if (value.is_number()) one["type"] = "float64";
    list.push_back(std::move(one));
  }
  Json message{{"op", "parameterValues"}, {"parameters", list}};
  if (id) message["id"] = *id;
  return to_text(message);
}

}  // namespace studio
