#include <pugixml.hpp>
#include <sstream>

#include "base/text.h"
#include "system/profile/rts_profile.h"

namespace tools {
namespace {

using base::Error;
using base::Result;

// Prefixes are the writer's choice, and so is the case of some elements (targets, Targets): only local names count.
std::string_view local(std::string_view name) {
  const auto colon = name.find(':');
  return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

std::string attribute(const pugi::xml_node& node, std::string_view name, const std::string& otherwise = "") {
  for (const auto& candidate : node.attributes()) {
    if (local(candidate.name()) == name && std::string_view(candidate.name()) != "xsi:type") return candidate.value();
  }
  return otherwise;
}

template <class F>
void each(const pugi::xml_node& node, std::string_view name, F f) {
  for (const auto& child : node.children()) {
    if (base::equal_ignoring_case(local(child.name()), name)) f(child);
  }
}

pugi::xml_node first(const pugi::xml_node& node, std::string_view name) {
  for (const auto& child : node.children()) {
    if (base::equal_ignoring_case(local(child.name()), name)) return child;
  }
  return {};
}

NamedValues properties_of(const pugi::xml_node& node) {
  NamedValues values;
  each(node, "Properties", [&](const auto& child) { values.emplace_back(attribute(child, "name"), attribute(child, "value")); });
  return values;
}

SavedComponent component_of(const pugi::xml_node& node) {
  SavedComponent component;
  component.id = attribute(node, "id");
  component.path_uri = attribute(node, "pathUri");
  component.active_set = attribute(node, "activeConfigurationSet");
  component.instance = attribute(node, "instanceName");
  component.composite_type = attribute(node, "compositeType", "None");
  component.is_required = base::parse_bool(attribute(node, "isRequired", "true")).value_or(true);
  each(node, "DataPorts", [&](const auto& child) { component.data_ports.push_back({attribute(child, "name")}); });
  each(node, "ServicePorts", [&](const auto& child) { component.service_ports.push_back({attribute(child, "name")}); });
  each(node, "ConfigurationSets", [&](const auto& set) {
    SavedConfigurationSet saved{attribute(set, "id"), {}};
    each(set, "ConfigurationData", [&](const auto& data) { saved.values.emplace_back(attribute(data, "name"), attribute(data, "data")); });
    component.configuration_sets.push_back(std::move(saved));
  });
  each(node, "ExecutionContexts", [&](const auto& child) {
    component.contexts.push_back(
        {attribute(child, "id", "0"), attribute(child, "kind", "PERIODIC"), attribute(child, "rate", "1000.0"), ""});
    for (const auto& [key, value] : properties_of(child)) {
      if (key == state_property) component.contexts.back().state = value;
    }
  });
  each(node, "Participants", [&](const auto& child) {
    const auto inner = first(child, "Participant");
    component.participants.push_back(attribute(inner ? inner : child, "instanceName"));
  });
  if (const auto location = first(node, "Location")) {
    const auto number = [&](const char* name) { return SavedPlace::pixels(attribute(location, name)); };
    component.place = {number("x"), number("y"), number("width"), number("height"),
                       base::to_lower(attribute(location, "direction", "down"))};
  }
  component.properties = properties_of(node);
  return component;
}

SavedTarget target_of(const pugi::xml_node& node) {
  SavedTarget target{attribute(node, "componentId"), attribute(node, "instanceName"), attribute(node, "portName"), ""};
  for (const auto& [key, value] : properties_of(node)) {
    if (key == "COMPONENT_PATH_ID") target.path_uri = value;
  }
  return target;
}

SavedConnector connector_of(const pugi::xml_node& node, bool is_data) {
  SavedConnector connector;
  connector.is_data = is_data;
  connector.id = attribute(node, "connectorId");
  connector.name = attribute(node, "name");
  connector.data_type = attribute(node, "dataType");
  connector.interface_type = attribute(node, "interfaceType");
  connector.dataflow_type = attribute(node, "dataflowType");
  connector.subscription_type = attribute(node, "subscriptionType");
  connector.source = target_of(first(node, is_data ? "sourceDataPort" : "sourceServicePort"));
  connector.target = target_of(first(node, is_data ? "targetDataPort" : "targetServicePort"));
  connector.properties = properties_of(node);
  return connector;
}

std::vector<SavedTurn> turns_of(const pugi::xml_node& list) {
  std::vector<SavedTurn> turns;
  each(list, "Targets", [&](const auto& node) {
    SavedTurn turn;
    turn.sequence = static_cast<int>(base::parse_integer(attribute(node, "sequence", "0")).value_or(0));
    const auto inner = first(node, "targetExecutionContext");
    const auto target = inner ? inner : first(node, "targetComponent");
    turn.component_id = attribute(target, "componentId");
    turn.instance = attribute(target, "instanceName");
    turn.context_id = attribute(target, "id", "0");
    for (const auto& [key, value] : properties_of(target)) {
      if (key == "COMPONENT_PATH_ID") turn.path_uri = value;
    }
    turns.push_back(std::move(turn));
  });
  return turns;
}

void put(pugi::xml_node node, const char* name, const std::string& value) { node.append_attribute(name) = value.c_str(); }

void put_properties(pugi::xml_node node, const NamedValues& properties) {
  for (const auto& [key, value] : properties) {
    auto child = node.append_child("rtsExt:Properties");
    put(child, "rtsExt:name", key);
    if (!value.empty()) put(child, "rtsExt:value", value);
  }
}

void put_component(pugi::xml_node root, const SavedComponent& component) {
  auto node = root.append_child("rts:Components");
  put(node, "xsi:type", "rtsExt:component_ext");
  put(node, "rts:id", component.id);
  put(node, "rts:pathUri", component.path_uri);
  if (!component.active_set.empty()) put(node, "rts:activeConfigurationSet", component.active_set);
  put(node, "rts:instanceName", component.instance);
  put(node, "rts:compositeType", component.composite_type);
  put(node, "rts:isRequired", component.is_required ? "true" : "false");
  put(node, "rtsExt:visible", "true");
  const auto put_ports = [&](const char* element, const char* type, const std::vector<SavedPort>& ports) {
    for (const auto& port : ports) {
      auto child = node.append_child(element);
      put(child, "xsi:type", type);
      put(child, "rts:name", port.name);
      put(child, "rtsExt:visible", "true");
    }
  };
  put_ports("rts:DataPorts", "rtsExt:dataport_ext", component.data_ports);
  put_ports("rts:ServicePorts", "rtsExt:serviceport_ext", component.service_ports);
  for (const auto& set : component.configuration_sets) {
    auto child = node.append_child("rts:ConfigurationSets");
    put(child, "rts:id", set.id);
    for (const auto& [key, value] : set.values) {
      auto data = child.append_child("rts:ConfigurationData");
      put(data, "rts:name", key);
      put(data, "rts:data", value);
    }
  }
  for (const auto& context : component.contexts) {
    auto child = node.append_child("rts:ExecutionContexts");
    put(child, "xsi:type", "rtsExt:execution_context_ext");
    put(child, "rts:id", context.id);
    put(child, "rts:kind", context.kind);
    put(child, "rts:rate", context.rate);
    if (!context.state.empty()) put_properties(child, {{state_property, context.state}});
  }
  for (const auto& participant : component.participants) {
    auto child = node.append_child("rts:Participants").append_child("rts:Participant");
    put(child, "xsi:type", "rtsExt:target_component_ext");
    put(child, "rts:componentId", "");
    put(child, "rts:instanceName", participant);
  }
  auto location = node.append_child("rtsExt:Location");
  const auto& place = component.place;
  for (const auto& [key, value] :
       {std::pair("rtsExt:x", place.x), {"rtsExt:y", place.y}, {"rtsExt:height", place.height}, {"rtsExt:width", place.width}})
    put(location, key, std::to_string(value));
  put(location, "rtsExt:direction", place.direction);
  put_properties(node, component.properties);
}

void put_target(pugi::xml_node connector, const char* element, const SavedTarget& target) {
  auto node = connector.append_child(element);
  put(node, "xsi:type", "rtsExt:target_port_ext");
  put(node, "rts:componentId", target.component_id);
  put(node, "rts:instanceName", target.instance);
  put(node, "rts:portName", target.port_name);
  put_properties(node, {{"COMPONENT_PATH_ID", target.path_uri}});
}

void put_connector(pugi::xml_node root, const SavedConnector& connector) {
  auto node = root.append_child(connector.is_data ? "rts:DataPortConnectors" : "rts:ServicePortConnectors");
  put(node, "xsi:type", connector.is_data ? "rtsExt:dataport_connector_ext" : "rtsExt:serviceport_connector_ext");
  put(node, "rts:connectorId", connector.id);
  put(node, "rts:name", connector.name);
  if (connector.is_data) {
    put(node, "rts:dataType", connector.data_type);
    put(node, "rts:interfaceType", connector.interface_type);
    put(node, "rts:dataflowType", connector.dataflow_type);
    put(node, "rts:subscriptionType", connector.subscription_type);
  }
  put(node, "rtsExt:visible", "true");
  put_target(node, connector.is_data ? "rts:sourceDataPort" : "rts:sourceServicePort", connector.source);
  put_target(node, connector.is_data ? "rts:targetDataPort" : "rts:targetServicePort", connector.target);
  put_properties(node, connector.properties);
}

void put_turns(pugi::xml_node root, const char* element, const std::vector<SavedTurn>& turns) {
  if (turns.empty()) return;
  auto list = root.append_child(element);
  for (const auto& turn : turns) {
    auto node = list.append_child("rts:Targets");
    put(node, "xsi:type", "rtsExt:condition_ext");
    put(node, "rts:sequence", std::to_string(turn.sequence));
    auto target = node.append_child("rts:targetExecutionContext");
    put(target, "xsi:type", "rtsExt:target_execution_context_ext");
    put(target, "rts:componentId", turn.component_id);
    put(target, "rts:instanceName", turn.instance);
    put(target, "rts:id", turn.context_id);
    put_properties(target, {{"COMPONENT_PATH_ID", turn.path_uri}});
  }
}

int line_at(const std::string& text, std::ptrdiff_t offset) {
  int line = 1;
  for (std::ptrdiff_t i = 0; i < offset && i < static_cast<std::ptrdiff_t>(text.size()); ++i)
    line += text[static_cast<std::size_t>(i)] == '\n';
  return line;
}

}  // namespace

Result<SavedSystem> parse_xml(const std::string& text, const std::string& file) {
  pugi::xml_document document;
  const auto parsed = document.load_buffer(text.data(), text.size());
  if (!parsed) return Error{file + ":" + std::to_string(line_at(text, parsed.offset)) + ": is no XML: " + parsed.description()};
  const auto root = first(document, "RtsProfile");
  if (!root) return Error{file + ": holds no RtsProfile element"};
  SavedSystem system;
  system.id = attribute(root, "id");
  system.abstract = attribute(root, "abstract");
  system.creation_date = attribute(root, "creationDate");
  system.update_date = attribute(root, "updateDate");
  if (const auto version = attribute(root, "version", "0.2"); version != "0.2") {
    return Error{file + ": RTSProfile version " + base::in_quotes(version) + " is not supported, expected \"0.2\""};
  }
  each(root, "Components", [&](const auto& node) { system.components.push_back(component_of(node)); });
  each(root, "DataPortConnectors", [&](const auto& node) { system.connectors.push_back(connector_of(node, true)); });
  each(root, "ServicePortConnectors", [&](const auto& node) { system.connectors.push_back(connector_of(node, false)); });
  system.start_up = turns_of(first(root, "StartUp"));
  system.shut_down = turns_of(first(root, "ShutDown"));
  return system;
}

std::string to_xml(const SavedSystem& system) {
  pugi::xml_document document;
  auto declaration = document.append_child(pugi::node_declaration);
  put(declaration, "version", "1.0");
  put(declaration, "encoding", "UTF-8");
  auto root = document.append_child("rts:RtsProfile");
  put(root, "xmlns:rts", "http://www.openrtp.org/namespaces/rts");
  put(root, "xmlns:rtsExt", "http://www.openrtp.org/namespaces/rts_ext");
  put(root, "xmlns:xsi", "http://www.w3.org/2001/XMLSchema-instance");
  put(root, "rts:id", system.id);
  put(root, "rts:abstract", system.abstract);
  put(root, "rts:creationDate", system.creation_date);
  put(root, "rts:updateDate", system.update_date);
  put(root, "rts:version", "0.2");
  for (const auto& component : system.components) put_component(root, component);
  for (const auto& connector : system.connectors) {
    if (connector.is_data) put_connector(root, connector);
  }
  for (const auto& connector : system.connectors) {
    if (!connector.is_data) put_connector(root, connector);
  }
  put_turns(root, "rts:StartUp", system.start_up);
  put_turns(root, "rts:ShutDown", system.shut_down);
  std::ostringstream out;
  document.save(out, "    ");
  return out.str();
}

}  // namespace tools
