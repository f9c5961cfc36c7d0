#include "system/profile/matched_system.h"

#include "base/text.h"

namespace editor {

std::string path_uri(const ComponentView& component) { return base::join(component.segments, "/"); }

bool is_reference(const std::string& key, const std::string& value) {
  return value.starts_with("IOR:") || key.ends_with("_ior") || key.ends_with("_ref");
}

Properties connect_properties(const SavedConnector& saved) {
  Properties properties;
  for (const auto& [key, value] : saved.properties) {
    if (!is_reference(key, value)) properties[key] = value;
  }
  if (!saved.is_data) return properties;
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) properties.emplace(key, value);
  };
  add("dataport.data_type", saved.data_type);
  add("dataport.interface_type", saved.interface_type);
  add("dataport.dataflow_type", saved.dataflow_type);
  add("dataport.subscription_type", saved.subscription_type);
  return properties;
}

Properties restored_properties(const SavedConnector& saved) {
  auto properties = connect_properties(saved);
  if (saved.is_data) properties.emplace("dataport.reconnect", "YES");
  return properties;
}

bool same_connection(const ConnectorView& connector, const PortView& source, const PortView& target) {
  bool has_source = false;
  bool has_target = false;
  for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
    has_source = has_source || connector.ports[i]->_is_equivalent(source.object);
    has_target = has_target || connector.ports[i]->_is_equivalent(target.object);
  }
  return has_source && has_target;
}

Matched::Matched(std::vector<ComponentView> components, const SavedSystem& system) : components_(std::move(components)) {
  for (const auto& saved : system.components) {
    const auto* component = find(saved.path_uri, saved.instance);
    if (!saved.is_required || (component && component->problem.empty())) continue;
    missing_.push_back({"component " + saved.path_uri + ": " + (component ? component->problem : "is not on the name server")});
  }
}

Result<Matched> Matched::read(const Session& session, const SavedSystem& system, Detail detail) {
  const auto names = session.tree();
  if (!names) return names.error();
  return Matched(read_components(*names, detail, session.call_timeout()), system);
}

const ComponentView* Matched::find(const std::string& uri, const std::string& instance) const {
  const ComponentView* by_name = nullptr;
  for (const auto& component : components_) {
    if (path_uri(component) == uri) return &component;
    const bool same = component.instance == instance || component.segments.back() == instance + ".rtc";
    if (same && (!by_name || !by_name->problem.empty())) by_name = &component;
  }
  return by_name;
}

const PortView* Matched::port(const SavedTarget& target) const {
  const auto* component = find(target.path_uri, target.instance);
  if (!component) return nullptr;
  const auto prefix = target.instance + ".";
  const auto name = target.port_name.starts_with(prefix) ? target.port_name.substr(prefix.size()) : target.port_name;
  return component->port(name);
}

}  // namespace editor
