#include "studio/system_json.h"

#include <map>
#include <set>
#include <unordered_map>

#include "base/text.h"
#include "run/time_members.h"

namespace studio {
namespace {

using tools::ComponentView;
using tools::ConfigurationSetView;
using tools::ContextView;
using tools::PortView;

std::string port_path(const ComponentView& component, const PortView& port) { return component.path + ":" + port.name; }

const char* kind_of(const PortView& port) {
  if (port.port_type() == "DataInPort") return "in";
  return port.port_type() == "DataOutPort" ? "out" : "service";
}

Json properties_json(const tools::Properties& properties) {
  Json json = Json::object();
  for (const auto& [key, value] : properties) json[key] = value;
  return json;
}

Json port_json(const PortView& port) {
  Json interfaces = Json::array();
  for (const auto& interface : port.interfaces)
    interfaces.push_back({{"instance", interface.instance}, {"type", interface.type}, {"provided", interface.is_provided}});
  return {{"name", port.name}, {"kind", kind_of(port)}, {"data_type", port.data_type()}, {"interfaces", interfaces}};
}

Json context_json(const ContextView& context, std::size_t index) {
  return {{"index", index},
          {"owned", context.is_owned},
          {"kind", tools::kind_text(context.kind)},
          {"rate", context.rate},
          {"running", context.is_running},
          {"state", tools::state_text(context.state)},
          {"type", tools::property(context.properties, "type")}};
}

Json component_json(const ComponentView& component) {
  Json contexts = Json::array(), ports = Json::array();
  for (std::size_t i = 0; i < component.contexts.size(); ++i) contexts.push_back(context_json(component.contexts[i], i));
  for (const auto& port : component.ports) ports.push_back(port_json(port));
  return {{"path", component.path},
          {"instance", component.instance},
          {"type", component.type},
          {"category", component.category},
          {"vendor", component.vendor},
          {"version", component.version},
          {"description", component.description},
          {"problem", component.problem},
          {"state", component.problem.empty() ? tools::state_text(component.state()) : "Unknown"},
          {"composite", component.category.starts_with("composite.")},
          {"members", component.members},
          {"active_set", component.active_set},
          {"in_simulated_time", tools::simulated_context(component) != nullptr},
          {"contexts", contexts},
          {"ports", ports}};
}

// Which component has a port, found by the hash of its reference: a system may have thousands of them.
class PortIndex {
 public:
  explicit PortIndex(const std::vector<ComponentView>& components) {
    for (const auto& component : components) {
      for (const auto& port : component.ports) {
        if (!CORBA::is_nil(port.object)) ports_.emplace(port.object->_hash(max_hash), Known{port.object, port_path(component, port)});
      }
    }
  }

  // Empty: nobody's.
  std::string path_of(RTC::PortService_ptr port) const {
    if (CORBA::is_nil(port)) return {};
    const auto [first, last] = ports_.equal_range(port->_hash(max_hash));
    for (auto known = first; known != last; ++known) {
      if (known->second.object->_is_equivalent(port)) return known->second.path;
    }
    return {};
  }

 private:
  static constexpr CORBA::ULong max_hash = 0x7fffffff;
  struct Known {
    RTC::PortService_ptr object;  // of the component, which lives as long
    std::string path;
  };
  std::unordered_multimap<CORBA::ULong, Known> ports_;
};

Json connection_json(const tools::ConnectorView& connector, const PortIndex& index) {
  Json ports = Json::array(), absent = Json::array();
  for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
    const auto path = index.path_of(connector.ports[i]);
    if (path.empty()) {
      absent.push_back("a port of a component that is not on this name server");
    } else {
      ports.push_back(path);
    }
  }
  return {{"id", connector.id},
          {"name", connector.name},
          {"ports", ports},
          {"absent", absent},
          {"properties", properties_json(connector.properties)}};
}

std::string value_in(const ComponentView& component, const char* set_id, const std::string& name) {
  for (const auto& set : component.configuration_sets) {
    if (set.id != set_id) continue;
    for (const auto& [key, value] : set.values) {
      if (key == name) return value;
    }
  }
  return {};
}

Json set_json(const ComponentView& component, const ConfigurationSetView& set) {
  Json values = Json::array();
  for (const auto& [name, value] : set.values) {
    values.push_back({{"name", name},
                      {"value", value},
                      {"type", value_in(component, "__type__", name)},
                      {"widget", value_in(component, "__widget__", name)},
                      {"constraint", value_in(component, "__constraints__", name)}});
  }
  return {{"id", set.id}, {"active", set.id == component.active_set}, {"values", values}};
}

}  // namespace

Json components_json(const std::vector<ComponentView>& components) {
  Json list = Json::array();
  for (const auto& component : components) list.push_back(component_json(component));
  return list;
}

Json connections_json(const std::vector<ComponentView>& components) {
  const PortIndex index(components);
  std::set<std::string> seen;
  Json list = Json::array();
  for (const auto& component : components) {
    for (const auto& port : component.ports) {
      for (const auto& connector : port.connectors) {
        if (seen.insert(connector.id).second) list.push_back(connection_json(connector, index));
      }
    }
  }
  return list;
}

Json managers_json(const tools::NamingTree& tree) {
  Json list = Json::array();
  for (const auto* entry : tree.objects()) {
    if (entry->kind == tools::EntryKind::manager) list.push_back({{"path", entry->path()}, {"problem", entry->problem}});
  }
  return list;
}

Json details_json(const ComponentView& component) {
  Json json = component_json(component);
  json["properties"] = properties_json(component.properties);
  for (std::size_t i = 0; i < component.ports.size(); ++i) {
    Json ids = Json::array();
    for (const auto& connector : component.ports[i].connectors) ids.push_back(connector.id);
    json["ports"][i]["properties"] = properties_json(component.ports[i].properties);
    json["ports"][i]["connections"] = ids;
  }
  for (std::size_t i = 0; i < component.contexts.size(); ++i)
    json["contexts"][i]["properties"] = properties_json(component.contexts[i].properties);
  json["sets"] = Json::array();
  for (const auto& set : component.configuration_sets) {
    if (!set.is_hidden()) json["sets"].push_back(set_json(component, set));
  }
  return json;
}

}  // namespace studio
