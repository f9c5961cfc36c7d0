#include "system/profile/matched_system.h"

#include "base/text.h"

namespace tools {

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
  if (&source == &target) return connector.ports.length() == 1 && connector.ports[0]->_is_equivalent(source.object);
  bool has_source = false;
  bool has_target = false;
  for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
    has_source = has_source || connector.ports[i]->_is_equivalent(source.object);
    has_target = has_target || connector.ports[i]->_is_equivalent(target.object);
  }
  return has_source && has_target;
}

Matched::Matched(std::vector<ComponentView> components, const SavedSystem& system) : components_(std::move(components)) {
  index();
  for (const auto& saved : system.components) {
    const auto* component = find(saved.path_uri, saved.instance);
    if (!saved.is_required) optional_.insert(saved.instance);
    if (component && component->problem.empty()) continue;
    const auto line = "component " + saved.path_uri + ": " + (component ? component->problem : "is not on the name server");
    if (saved.is_required) missing_.push_back({line});
    if (!saved.is_required) absent_.push_back(line + "; it is left out, as the profile does not require it");
  }
}

Result<Matched> Matched::read(const Session& session, const SavedSystem& system, Detail detail) {
  const auto names = session.tree();
  if (!names) return names.error();
  return Matched(read_components(*names, detail, session.call_timeout()), system);
}

// Of several with one name the first that answers counts, else the first.
void Matched::index() {
  for (std::size_t i = 0; i < components_.size(); ++i) {
    const auto& component = components_[i];
    by_uri_.emplace(path_uri(component), i);
    auto bound = component.segments.back();
    if (bound.ends_with(".rtc")) bound.resize(bound.size() - std::string(".rtc").size());
    for (const auto& name : {component.instance, bound}) {
      const auto [at, is_new] = by_name_.emplace(name, i);
      if (!is_new && !components_[at->second].problem.empty() && component.problem.empty()) at->second = i;
    }
  }
}

const ComponentView* Matched::find(const std::string& uri, const std::string& instance) const {
  if (const auto found = by_uri_.find(uri); found != by_uri_.end()) return &components_[found->second];
  const auto found = by_name_.find(instance);
  return found == by_name_.end() ? nullptr : &components_[found->second];
}

bool Matched::leaves_out(const SavedTarget& target) const {
  return optional_.contains(target.instance) && !find(target.path_uri, target.instance);
}

Result<const PortView*> Matched::port(const SavedTarget& target) const {
  const auto* component = find(target.path_uri, target.instance);
  if (!component) return Error{"there is no component " + (target.instance.empty() ? target.path_uri : target.instance)};
  const auto prefix = target.instance + ".";
  const auto name = target.port_name.starts_with(prefix) ? target.port_name.substr(prefix.size()) : target.port_name;
  if (const auto* port = component->port(name)) return port;
  if (!component->problem.empty()) return Error{"component " + component->path + " " + component->problem};
  std::vector<std::string> names;
  for (const auto& port : component->ports) names.push_back(port.name);
  return Error{component->path + " has no port " + base::in_quotes(name) +
               (names.empty() ? "; it has none" : "; it has " + base::join(names, ", "))};
}

}  // namespace tools
