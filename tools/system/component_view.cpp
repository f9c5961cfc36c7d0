#include "system/component_view.h"

#include <algorithm>

#include "rtm/idl/OpenRTMStub.h"

namespace tools {
namespace {

ConnectorView to_view(const RTC::ConnectorProfile& profile) {
  return {profile.connector_id.in(), profile.name.in(), to_properties(profile.properties), profile.ports};
}

PortView to_view(const RTC::PortProfile& profile, const std::string& instance) {
  PortView port;
  port.full_name = profile.name.in();
  port.name = port.full_name.starts_with(instance + ".") ? port.full_name.substr(instance.size() + 1) : port.full_name;
  port.properties = to_properties(profile.properties);
  port.object = RTC::PortService::_duplicate(profile.port_ref);
  for (CORBA::ULong i = 0; i < profile.interfaces.length(); ++i) {
    const auto& interface = profile.interfaces[i];
    port.interfaces.push_back({interface.instance_name.in(), interface.type_name.in(), interface.polarity == RTC::PROVIDED});
  }
  for (CORBA::ULong i = 0; i < profile.connector_profiles.length(); ++i) port.connectors.push_back(to_view(profile.connector_profiles[i]));
  return port;
}

void read_connectors(PortView& port) {
  if (CORBA::is_nil(port.object)) return;
  RTC::ConnectorProfileList_var list = port.object->get_connector_profiles();
  port.connectors.clear();
  for (CORBA::ULong i = 0; i < list->length(); ++i) port.connectors.push_back(to_view(list[i]));
}

void read_context(ComponentView& component, RTC::ExecutionContext_ptr context, bool is_owned) {
  if (CORBA::is_nil(context)) return;
  ContextView view;
  view.is_owned = is_owned;
  view.object = RTC::ExecutionContext::_duplicate(context);
  view.handle = component.object->get_context_handle(context);
  view.state = context->get_component_state(component.object);
  view.is_running = context->is_running();
  view.rate = context->get_rate();
  view.kind = context->get_kind();
  const auto service = RTC::ExecutionContextService::_narrow(context);
  if (!CORBA::is_nil(service)) {
    RTC::ExecutionContextProfile_var profile = service->get_profile();
    view.properties = to_properties(profile->properties);
  }
  component.contexts.push_back(std::move(view));
}

void read_contexts(ComponentView& component) {
  RTC::ExecutionContextList_var owned = component.object->get_owned_contexts();
  for (CORBA::ULong i = 0; i < owned->length(); ++i) read_context(component, owned[i], true);
  RTC::ExecutionContextList_var others = component.object->get_participating_contexts();
  for (CORBA::ULong i = 0; i < others->length(); ++i) {
    try {
      read_context(component, others[i], false);
    } catch (const CORBA::Exception& exception) {  // a context of another process: the component itself is well
      ContextView gone;
      gone.is_owned = false;
      gone.object = RTC::ExecutionContext::_duplicate(others[i]);
      gone.handle = component.object->get_context_handle(others[i]);
      gone.problem = describe(exception);
      component.contexts.push_back(std::move(gone));
    }
  }
}

void read_configuration(ComponentView& component) {
  const SDOPackage::Configuration_var configuration = component.object->get_configuration();
  if (CORBA::is_nil(configuration)) return;
  SDOPackage::ConfigurationSetList_var sets = configuration->get_configuration_sets();
  for (CORBA::ULong i = 0; i < sets->length(); ++i) {
    ConfigurationSetView set{sets[i].id.in(), {}};
    const auto& data = sets[i].configuration_data;
    for (CORBA::ULong n = 0; n < data.length(); ++n) {
      const char* text = nullptr;
      if (data[n].value >>= text) set.values.emplace_back(data[n].name.in(), text);
    }
    component.configuration_sets.push_back(std::move(set));
  }
  try {
    SDOPackage::ConfigurationSet_var active = configuration->get_active_configuration_set();
    component.active_set = active->id.in();
  } catch (const SDOPackage::NotAvailable&) {   // values were set and not yet activated
  } catch (const SDOPackage::InternalError&) {  // some runtimes say it this way
  }
}

void read_members(ComponentView& component) {
  SDOPackage::OrganizationList_var organizations = component.object->get_owned_organizations();
  for (CORBA::ULong i = 0; i < organizations->length(); ++i) {
    SDOPackage::SDOList_var members = organizations[i]->get_members();
    for (CORBA::ULong n = 0; n < members->length(); ++n) {
      try {
        CORBA::String_var id = members[n]->get_sdo_id();
        component.members.emplace_back(id.in());
      } catch (const CORBA::Exception& exception) {  // one dead member hides neither the others nor the composite
        component.members.emplace_back("(a member that " + describe(exception) + ")");
      }
    }
  }
}

void read_profile(ComponentView& component) {
  RTC::ComponentProfile_var profile = component.object->get_component_profile();
  component.instance = profile->instance_name.in();
  component.type = profile->type_name.in();
  component.category = profile->category.in();
  component.vendor = profile->vendor.in();
  component.version = profile->version.in();
  component.description = profile->description.in();
  component.properties = to_properties(profile->properties);
  for (CORBA::ULong i = 0; i < profile->port_profiles.length(); ++i) {
    component.ports.push_back(to_view(profile->port_profiles[i], component.instance));
  }
}

}  // namespace

// A member of a composite has its own context stopped and runs in another. One that has joined simulated time has two that run.
const ContextView* ComponentView::shown_context() const {
  if (contexts.empty()) return nullptr;
  for (const auto& context : contexts) {
    if (!context.is_owned && context.is_running && tools::property(context.properties, "type") == "SimTimeContext") return &context;
  }
  const auto running = std::find_if(contexts.begin(), contexts.end(), [](const ContextView& context) { return context.is_running; });
  return running == contexts.end() ? &contexts.front() : &*running;
}

RTC::LifeCycleState ComponentView::state() const {
  const auto* context = shown_context();
  return context ? context->state : RTC::CREATED_STATE;
}

const PortView* ComponentView::port(const std::string& name) const {
  for (const auto& candidate : ports) {
    if (candidate.name == name || candidate.full_name == name) return &candidate;
  }
  return nullptr;
}

ComponentView read_component(const Entry& entry, Detail detail) {
  ComponentView component;
  component.path = entry.path();
  component.segments = entry.segments;
  component.instance = entry.id;
  if (entry.health != Health::alive) {
    component.problem = entry.problem;
    return component;
  }
  const auto read = remote("component " + entry.path(), [&] {
    component.object = RTC::RTObject::_narrow(entry.object);
    if (CORBA::is_nil(component.object)) {
      component.problem = "is no RT component";
      return;
    }
    read_profile(component);
    if (detail.contexts) read_contexts(component);
    if (detail.connectors) {
      for (auto& port : component.ports) read_connectors(port);
    }
    if (detail.configuration) read_configuration(component);
    if (detail.members) read_members(component);
  });
  if (!read) component.problem = read.error().message.substr(("component " + entry.path() + " ").size());
  return component;
}

std::vector<ComponentView> read_components(const NamingTree& tree, Detail detail, std::chrono::milliseconds limit) {
  std::vector<const Entry*> entries;
  for (const auto* entry : tree.objects()) {
    if (entry->kind == EntryKind::component) entries.push_back(entry);
  }
  std::vector<ComponentView> components(entries.size());
  in_parallel(entries.size(), limit, [&](std::size_t i) { components[i] = read_component(*entries[i], detail); });
  return components;
}

std::string absent_port(RTC::PortService_ptr port) {
  try {
    return CORBA::is_nil(port) || port->_non_existent() ? "a port that does not exist any more"
                                                        : "a port of a component that is not on the name server";
  } catch (const CORBA::Exception& e) {
    return is_time_out(e) ? "a port that does not answer" : "a port that does not exist any more";
  }
}

namespace {

constexpr CORBA::ULong hash_limit = 0x7fffffff;

}  // namespace

PortIndex::PortIndex(const std::vector<ComponentView>& components) {
  for (const auto& component : components) {
    for (const auto& port : component.ports) {
      if (!CORBA::is_nil(port.object)) owners_.emplace(port.object->_hash(hash_limit), PortOwner{&component, &port});
    }
  }
}

PortOwner PortIndex::owner_of(RTC::PortService_ptr port) const {
  if (CORBA::is_nil(port)) return {};
  for (auto [at, end] = owners_.equal_range(port->_hash(hash_limit)); at != end; ++at) {
    if (at->second.port->object->_is_equivalent(port)) return at->second;
  }
  return {};
}

PortOwner owner_of(RTC::PortService_ptr port, const std::vector<ComponentView>& components) {
  for (const auto& component : components) {
    for (const auto& candidate : component.ports) {
      if (!CORBA::is_nil(candidate.object) && candidate.object->_is_equivalent(port)) return {&component, &candidate};
    }
  }
  return {};
}

}  // namespace tools
