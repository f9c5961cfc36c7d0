#include <yaml-cpp/yaml.h>

#include <cstdio>

#include "base/text.h"
#include "base/yaml_keys.h"
#include "system/profile/rts_profile.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

// Keys come with and without the "rtsExt::" prefix, depending on the writer.
YAML::Node child(const YAML::Node& node, const std::string& key) {
  if (!node.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
  if (const auto direct = node[key]) return direct;
  return node["rtsExt::" + key];
}

std::string text(const YAML::Node& node, const std::string& key, const std::string& otherwise = "") {
  const auto value = child(node, key);
  return value && value.IsScalar() ? value.Scalar() : otherwise;
}

// "2008-05-06T13:49:53", also from a map of its parts.
std::string date(const YAML::Node& node, const std::string& key) {
  const auto value = child(node, key);
  if (!value || !value.IsMap()) return text(node, key);
  const auto part = [&](const char* name) { return static_cast<int>(base::parse_integer(text(value, name, "0")).value_or(0)); };
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%04d-%02d-%02dT%02d:%02d:%02d", part("year"), part("month"), part("day"), part("hour"),
                part("minute"), part("second"));
  return buffer;
}

// One entry or a list of them.
template <class F>
void each(const YAML::Node& node, const std::string& key, F f) {
  const auto list = child(node, key);
  if (!list || list.IsNull()) return;
  if (!list.IsSequence()) return f(list);
  for (const auto& entry : list) f(entry);
}

NamedValues properties_of(const YAML::Node& node) {
  NamedValues values;
  each(node, "properties", [&](const YAML::Node& entry) { values.emplace_back(text(entry, "name"), text(entry, "value")); });
  return values;
}

std::string path_of(const YAML::Node& node) {
  for (const auto& [key, value] : properties_of(node)) {
    if (key == "COMPONENT_PATH_ID") return value;
  }
  return "";
}

SavedComponent component_of(const YAML::Node& node) {
  SavedComponent component;
  component.id = text(node, "id");
  component.path_uri = text(node, "pathUri");
  component.active_set = text(node, "activeConfigurationSet");
  component.instance = text(node, "instanceName");
  component.composite_type = text(node, "compositeType", "None");
  component.is_required = base::parse_bool(text(node, "isRequired", "true")).value_or(true);
  each(node, "dataPorts", [&](const YAML::Node& entry) { component.data_ports.push_back({text(entry, "name")}); });
  each(node, "servicePorts", [&](const YAML::Node& entry) { component.service_ports.push_back({text(entry, "name")}); });
  each(node, "configurationSets", [&](const YAML::Node& entry) {
    SavedConfigurationSet set{text(entry, "id"), {}};
    each(entry, "configurationData", [&](const YAML::Node& data) { set.values.emplace_back(text(data, "name"), text(data, "data")); });
    component.configuration_sets.push_back(std::move(set));
  });
  each(node, "executionContexts", [&](const YAML::Node& entry) {
    component.contexts.push_back({text(entry, "id", "0"), text(entry, "kind", "PERIODIC"), text(entry, "rate", "1000.0"), ""});
    for (const auto& [key, value] : properties_of(entry)) {
      if (key == state_property) component.contexts.back().state = value;
    }
  });
  each(node, "participants", [&](const YAML::Node& entry) {
    const auto inner = child(entry, "participant");
    component.participants.push_back(text(inner ? inner : entry, "instanceName"));
  });
  if (const auto location = child(node, "location")) {
    const auto number = [&](const char* name) { return SavedPlace::pixels(text(location, name)); };
    component.place = {number("x"), number("y"), number("width"), number("height"), base::to_lower(text(location, "direction", "down"))};
  }
  component.properties = properties_of(node);
  return component;
}

SavedTarget target_of(const YAML::Node& node) {
  return {text(node, "componentId"), text(node, "instanceName"), text(node, "portName"), path_of(node)};
}

SavedConnector connector_of(const YAML::Node& node, bool is_data) {
  SavedConnector connector;
  connector.is_data = is_data;
  connector.id = text(node, "connectorId");
  connector.name = text(node, "name");
  connector.data_type = text(node, "dataType");
  connector.interface_type = text(node, "interfaceType");
  connector.dataflow_type = text(node, "dataflowType");
  connector.subscription_type = text(node, "subscriptionType");
  connector.source = target_of(child(node, is_data ? "sourceDataPort" : "sourceServicePort"));
  connector.target = target_of(child(node, is_data ? "targetDataPort" : "targetServicePort"));
  connector.properties = properties_of(node);
  return connector;
}

std::vector<SavedTurn> turns_of(const YAML::Node& list) {
  std::vector<SavedTurn> turns;
  if (!list) return turns;
  each(list, "targets", [&](const YAML::Node& node) {
    const auto inner = child(node, "targetExecutionContext");
    const auto target = inner ? inner : child(node, "targetComponent");
    if (!target) return;
    const auto sequence = static_cast<int>(base::parse_integer(text(node, "sequence", "0")).value_or(0));
    turns.push_back({text(target, "instanceName"), path_of(target), text(target, "componentId"), text(target, "id", "0"), sequence});
  });
  return turns;
}

// Numbers and truth values are written as such; every other scalar in quotes, since readers take a bare 0.2 for a number.
constexpr auto bare_tag = "bare";
template <class T>
YAML::Node bare(const T& value) {
  YAML::Node node(value);
  node.SetTag(bare_tag);
  return node;
}

void emit(YAML::Emitter& out, const YAML::Node& node) {
  if (node.IsMap()) {
    out << YAML::BeginMap;
    for (const auto& entry : node) {
      out << YAML::Key << entry.first.Scalar() << YAML::Value;
      emit(out, entry.second);
    }
    out << YAML::EndMap;
  } else if (node.IsSequence()) {
    out << YAML::BeginSeq;
    for (const auto& entry : node) emit(out, entry);
    out << YAML::EndSeq;
  } else if (node.Tag() == bare_tag) {
    out << node.Scalar();
  } else {
    out << YAML::DoubleQuoted << (node.IsScalar() ? node.Scalar() : "");
  }
}

YAML::Node from_date(const std::string& iso) {
  int year = 1, month = 1, day = 1, hour = 0, minute = 0, second = 0;
  std::sscanf(iso.c_str(), "%d-%d-%dT%d:%d:%d", &year, &month, &day, &hour, &minute, &second);
  YAML::Node node;
  node["year"] = bare(year);
  node["month"] = bare(month);
  node["day"] = bare(day);
  node["hour"] = bare(hour);
  node["minute"] = bare(minute);
  node["second"] = bare(second);
  return node;
}

YAML::Node from_properties(const NamedValues& properties) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (const auto& [key, value] : properties) {
    YAML::Node entry;
    entry["name"] = key;
    entry["value"] = value;
    list.push_back(entry);
  }
  return list;
}

std::string in_capitals(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

YAML::Node from_component(const SavedComponent& component) {
  YAML::Node node;
  node["id"] = component.id;
  node["pathUri"] = component.path_uri;
  node["activeConfigurationSet"] = component.active_set;
  node["instanceName"] = component.instance;
  node["compositeType"] = component.composite_type;
  node["isRequired"] = bare(component.is_required);
  node["rtsExt::visible"] = bare(true);
  const auto add_ports = [&](const char* key, const std::vector<SavedPort>& ports) {
    for (const auto& port : ports) {
      YAML::Node entry;
      entry["name"] = port.name;
      entry["rtsExt::visible"] = bare(true);
      node[key].push_back(entry);
    }
  };
  add_ports("dataPorts", component.data_ports);
  add_ports("servicePorts", component.service_ports);
  for (const auto& set : component.configuration_sets) {
    YAML::Node entry;
    entry["id"] = set.id;
    for (const auto& [key, value] : set.values) {
      YAML::Node data;
      data["name"] = key;
      data["data"] = value;
      entry["configurationData"].push_back(data);
    }
    node["configurationSets"].push_back(entry);
  }
  for (const auto& context : component.contexts) {
    YAML::Node entry;
    entry["id"] = context.id;
    entry["kind"] = context.kind;
    entry["rate"] = bare(context.rate);
    if (!context.state.empty()) entry["rtsExt::properties"] = from_properties({{state_property, context.state}});
    node["executionContexts"].push_back(entry);
  }
  for (const auto& participant : component.participants) {
    YAML::Node entry;
    entry["participant"]["instanceName"] = participant;
    entry["participant"]["componentId"] = "";
    node["participants"].push_back(entry);
  }
  auto location = node["rtsExt::location"];
  const auto& place = component.place;
  for (const auto& [key, value] : {std::pair("x", place.x), {"y", place.y}, {"height", place.height}, {"width", place.width}})
    location[key] = bare(value);
  location["direction"] = in_capitals(place.direction);
  node["rtsExt::properties"] = from_properties(component.properties);
  return node;
}

YAML::Node from_target(const SavedTarget& target) {
  YAML::Node node;
  node["componentId"] = target.component_id;
  node["instanceName"] = target.instance;
  node["portName"] = target.port_name;
  node["rtsExt::properties"] = from_properties({{"COMPONENT_PATH_ID", target.path_uri}});
  return node;
}

YAML::Node from_connector(const SavedConnector& connector) {
  YAML::Node node;
  node["connectorId"] = connector.id;
  node["name"] = connector.name;
  if (connector.is_data) {
    node["dataType"] = connector.data_type;
    node["interfaceType"] = connector.interface_type;
    node["dataflowType"] = connector.dataflow_type;
    node["subscriptionType"] = connector.subscription_type;
  }
  node[connector.is_data ? "sourceDataPort" : "sourceServicePort"] = from_target(connector.source);
  node[connector.is_data ? "targetDataPort" : "targetServicePort"] = from_target(connector.target);
  node["rtsExt::properties"] = from_properties(connector.properties);
  return node;
}

YAML::Node from_turns(const std::vector<SavedTurn>& turns) {
  YAML::Node node;
  for (const auto& turn : turns) {
    YAML::Node entry;
    entry["sequence"] = bare(turn.sequence);
    auto target = entry["targetExecutionContext"];
    target["instanceName"] = turn.instance;
    target["componentId"] = turn.component_id;
    target["id"] = turn.context_id;
    target["rtsExt::properties"] = from_properties({{"COMPONENT_PATH_ID", turn.path_uri}});
    node["targets"].push_back(entry);
  }
  return node;
}

}  // namespace

Result<SavedSystem> parse_yaml(const std::string& content, const std::string& file) {
  YAML::Node root;
  try {
    root = YAML::Load(content);
    yaml::expect_unique_keys(root);
    if (!root.IsMap() || !root["rtsProfile"]) return Error{file + ": holds no rtsProfile"};
    const auto profile = root["rtsProfile"];
    SavedSystem system;
    system.id = text(profile, "id");
    system.abstract = text(profile, "abstract");
    system.creation_date = date(profile, "creationDate");
    system.update_date = date(profile, "updateDate");
    each(profile, "components", [&](const YAML::Node& node) { system.components.push_back(component_of(node)); });
    each(profile, "dataPortConnectors", [&](const YAML::Node& node) { system.connectors.push_back(connector_of(node, true)); });
    each(profile, "servicePortConnectors", [&](const YAML::Node& node) { system.connectors.push_back(connector_of(node, false)); });
    system.start_up = turns_of(child(profile, "startUp"));
    system.shut_down = turns_of(child(profile, "shutDown"));
    return system;
  } catch (const YAML::Exception& e) {
    return Error{file + ":" + std::to_string(e.mark.line + 1) + ": is no YAML: " + e.msg};
  }
}

std::string to_yaml(const SavedSystem& system) {
  YAML::Node root;
  auto profile = root["rtsProfile"];
  profile["id"] = system.id;
  profile["abstract"] = system.abstract;
  profile["creationDate"] = from_date(system.creation_date);
  profile["updateDate"] = from_date(system.update_date);
  profile["version"] = "0.2";
  for (const auto& component : system.components) profile["components"].push_back(from_component(component));
  for (const auto& connector : system.connectors) {
    profile[connector.is_data ? "dataPortConnectors" : "servicePortConnectors"].push_back(from_connector(connector));
  }
  if (!system.start_up.empty()) profile["startUp"] = from_turns(system.start_up);
  if (!system.shut_down.empty()) profile["shutDown"] = from_turns(system.shut_down);
  YAML::Emitter out;
  emit(out, root);
  return std::string(out.c_str()) + "\n";
}

}  // namespace tools
