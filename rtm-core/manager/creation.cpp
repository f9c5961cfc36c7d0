// How components come into being: factories, creation from an argument, names.
#include <algorithm>

#include "base/log.h"
#include "base/text.h"
#include "corba/orb/principal.h"
#include "core/config_file.h"
#include "core/name_format.h"
#include "core/remote_rights.h"
#include "manager/manager_impl.h"
#include "rtm/ModuleManager.h"
#include "rtm/NamingManager.h"

namespace RTC {
namespace {

rt::ComponentId id_of(const coil::Properties& profile) {
  const auto first = [&](const char* a, const char* b) {
    const auto& value = profile.getProperty(a);
    return value.empty() ? profile.getProperty(b) : value;
  };
  return {profile.getProperty("vendor"), profile.getProperty("category"), first("implementation_id", "type_name"),
          profile.getProperty("language"), profile.getProperty("version")};
}

std::string to_text(const rt::ComponentId& id) {
  return "RTC:" + id.vendor + ":" + id.category + ":" + id.implementation_id + ":" + id.language + ":" + id.version;
}

// The nodes of the manager's configuration that every component starts from.
constexpr const char* inherited_nodes[] = {"config.version",
                                           "openrtm.name",
                                           "openrtm.version",
                                           "os.name",
                                           "os.release",
                                           "os.version",
                                           "os.arch",
                                           "os.hostname",
                                           "corba.endpoint",
                                           "corba.endpoints",
                                           "corba.id",
                                           "exec_cxt",
                                           "ec",
                                           "execution_contexts",
                                           "periodic_task",
                                           "logger.enable",
                                           "logger.log_level",
                                           "naming.enable",
                                           "naming.type",
                                           "naming.formats",
                                           "port",
                                           "sdo",
                                           "config_file",
                                           "manager.instance_name"};

// Of a component in naming services: each may have folders of its own, and is looked after as long as the component lives.
constexpr std::size_t max_names = 16;

// Keys of a creation argument that say where and how to create, not what.
bool is_directive(const std::string& key) { return key == "manager_name" || key == "manager_address" || key == "language"; }

}  // namespace

// --- factories

bool ManagerImpl::register_factory(const coil::Properties& profile, RtcNewFunc create_function, RtcDeleteFunc destroy) {
  if (create_function == nullptr || destroy == nullptr) {
    RTC_ERROR(("a factory without functions is not registered"));
    return false;
  }
  return register_factory(std::make_shared<FactoryCXX>(profile, create_function, destroy));
}

bool ManagerImpl::register_factory(std::shared_ptr<FactoryBase> factory) {
  const auto id = id_of(factory->profile());
  if (id.implementation_id.empty()) {
    RTC_ERROR(("a factory without implementation_id is not registered"));
    return false;
  }
  bool is_known = false;
  {
    auto locked = state.lock();
    is_known = std::any_of(locked->factories.begin(), locked->factories.end(),
                           [&](const auto& registered) { return id_of(registered.factory->profile()) == id; });
    if (!is_known) locked->factories.push_back({std::move(factory), current_module});
  }
  if (is_known) RTC_WARN(("factory %s is registered already", base::in_quotes(to_text(id)).c_str()));
  return !is_known;
}

std::optional<ManagerImpl::RegisteredFactory> ManagerImpl::find_factory(const rt::ComponentId& id) const {
  const auto locked = state.lock();
  for (const auto& registered : locked->factories) {
    if (rt::is_match(id, id_of(registered.factory->profile()))) return registered;
  }
  return std::nullopt;
}

// The place counts from here on: no other caller unloads a module between the look at its factory and the component that comes of it.
std::optional<ManagerImpl::Record> ManagerImpl::take_place(const rt::ComponentId& id) {
  auto locked = state.lock();
  for (const auto& registered : locked->factories) {
    if (!rt::is_match(id, id_of(registered.factory->profile()))) continue;
    auto& record = locked->records[++locked->last_id];
    record.id = locked->last_id;
    record.factory = registered.factory;
    record.module = registered.module;
    return record;
  }
  return std::nullopt;
}

std::size_t ManagerImpl::forget_module(const std::string& module) {
  auto locked = state.lock();
  const auto living = static_cast<std::size_t>(
      std::count_if(locked->records.begin(), locked->records.end(), [&](const auto& entry) { return entry.second.module == module; }) +
      std::count_if(locked->abandoned.begin(), locked->abandoned.end(), [&](const auto& record) { return record.module == module; }));
  if (living == 0) std::erase_if(locked->factories, [&](const auto& registered) { return registered.module == module; });
  return living;
}

bool Manager::registerFactory(coil::Properties& profile, RtcNewFunc new_func, RtcDeleteFunc delete_func) {
  return impl_->register_factory(profile, new_func, delete_func);
}

std::vector<coil::Properties> Manager::getFactoryProfiles() {
  std::vector<coil::Properties> profiles;
  const auto factories = impl_->state.lock()->factories;
  for (const auto& registered : factories) profiles.push_back(registered.factory->profile());
  return profiles;
}

std::vector<std::string> Manager::getModulesFactories() {
  std::vector<std::string> names;
  for (const auto& profile : getFactoryProfiles()) names.push_back(id_of(profile).implementation_id);
  return names;
}

// --- creation

// Start scripts that run twice work: what is asked for under a name that a component of the type has is that component.
RTObject_impl* ManagerImpl::existing_component(const rt::ComponentArgument& argument, const coil::Properties& profile) const {
  const auto name = std::ranges::find(argument.properties, "instance_name", [](const auto& property) { return property.first; });
  if (name == argument.properties.end()) return nullptr;
  const auto locked = state.lock();
  for (const auto& [id, record] : locked->records) {
    if (record.listed && !record.finalized && record.component && record.factory && record.instance_name == name->second &&
        id_of(record.factory->profile()) == id_of(profile))
      return record.component;
  }
  return nullptr;
}

base::Result<RTObject_impl*> ManagerImpl::create(std::string argument) {
  {
    auto locked = state.lock();
    const bool is_running = (locked->phase == Phase::started || locked->phase == Phase::active) && !locked->end_requested;
    if (!is_running) return base::Error{"component " + base::in_quotes(argument) + ": the manager is not running"};
  }
  listeners.rtclifecycle_.call(&RTM::RtcLifecycleActionListener::preCreate, argument);
  const auto parsed = rt::parse_component_argument(argument);
  if (!parsed) return parsed.error();

  auto place = take_place(parsed->id);
  if (!place && flag("manager.modules.search_auto", true)) {
    const auto& name = parsed->id.implementation_id;
    if (!modules->findFile(name).empty() && facade.load(name) == RTC_OK) place = take_place(parsed->id);
  }
  if (!place) {
    return base::Error{"component " + base::in_quotes(argument) +
                       ": no factory of that type is registered and no module of that name is in " +
                       described_load_path(value("manager.modules.load_path"))};
  }
  if (auto* existing = existing_component(*parsed, place->factory->profile())) {
    state.lock()->records.erase(place->id);
    RTC_INFO(("component %s exists already", base::in_quotes(manage(existing)->instance_name()).c_str()));
    return existing;
  }
  auto* component = place->factory->create(&facade);
  if (component == nullptr) {
    state.lock()->records.erase(place->id);
    return base::Error{"component " + base::in_quotes(argument) + ": its factory made none"};
  }
  state.lock()->records[place->id].component = component;
  auto result = try_to_finish_creation(*place, *parsed);
  if (!result) {
    destroy(place->id);
    return base::Error{"component " + base::in_quotes(argument) + ": " + result.error().message};
  }
  listeners.rtclifecycle_.call(&RTM::RtcLifecycleActionListener::postCreate, component);
  return result;
}

coil::Properties ManagerImpl::inherited_properties() const {
  coil::Properties properties;
  const auto mine = config_turn.take();
  for (const auto* path : inherited_nodes) {
    const auto* node = config.findNode(path);
    if (node == nullptr) continue;
    if (*node->getValue() != '\0' || *node->getDefaultValue() != '\0') {
      properties.setProperty(path, *node->getValue() != '\0' ? node->getValue() : node->getDefaultValue());
    }
    for (const auto& name : node->propertyNames()) {
      const auto& text = static_cast<const coil::Properties&>(*node).getProperty(name);
      if (!text.empty()) properties.setProperty(std::string(path) + "." + name, text);
    }
  }
  return properties;
}

// The settings in a component's own file; what is wrong with it is logged.
coil::Properties ManagerImpl::properties_of_file(const std::string& named_by, const std::string& file) {
  coil::Properties properties;
  if (file.empty()) return properties;
  const auto text = rt::read_text_file(file);
  if (!text) {
    RTC_WARN(("%s: %s", named_by.c_str(), text.error().message.c_str()));
    return properties;
  }
  const auto parsed = rt::parse_config(*text);
  for (const auto& finding : parsed.findings) RTC_WARN(("%s:%d: %s", file.c_str(), finding.line, finding.text.c_str()));
  for (const auto& entry : parsed.entries) properties.setProperty(entry.key, entry.value);
  return properties;
}

// What rtc.conf says in line about a type or an instance, and the file it names.
coil::Properties ManagerImpl::configured_properties(const std::string& category, const std::string& name) {
  coil::Properties properties;
  if (category.empty() || name.empty()) return properties;
  const bool is_ours = corba::principal() != corba::Principal::own && rt::is_protected_key(category + "." + name);
  if (is_ours) return properties;  // a stranger chooses the name, and sees the properties
  coil::Properties in_line;
  {
    const auto mine = config_turn.take();
    if (const auto* node = config.findNode(category + "." + name)) in_line = *node;
  }
  const auto file_key = category + "." + name + ".config_file";
  properties << properties_of_file(where(file_key) + file_key, in_line.getProperty("config_file"));
  for (const auto& key : in_line.propertyNames()) {
    properties.setProperty(key, static_cast<const coil::Properties&>(in_line).getProperty(key));
  }
  return properties;
}

base::Result<std::string> ManagerImpl::name_component(const Managed& component, const rt::ComponentArgument& argument, bool& numbered) {
  std::string name;
  for (const auto& [key, text] : argument.properties) {
    if (key == "instance_name") name = text;
  }
  const bool is_given =
      std::any_of(argument.properties.begin(), argument.properties.end(), [](const auto& p) { return p.first == "instance_name"; });
  if (is_given) {
    if (auto checked = rt::check_instance_name(name); !checked) return checked.error();
  }
  {
    // Those with a name of their own count too: T0, mine, T2.
    const auto mine = numbering_turn.take(numbering_timeout);
    if (!mine) return base::Error{"the naming policy " + value("manager.components.naming_policy") + " is busy with another component"};
    const std::string number = numbering->onCreate(component.object());
    numbered = true;
    if (!is_given) name = component.type_name() + number;
  }
  auto locked = state.lock();
  if (!locked->reserved_names.insert(name).second) return base::Error{"instance name " + base::in_quotes(name) + " exists already"};
  return name;
}

std::vector<std::string> ManagerImpl::naming_names(const Managed& component, const coil::Properties& properties) const {
  std::vector<std::string> names;
  if (!base::parse_bool(properties.getProperty("naming.enable")).value_or(true)) return names;
  const auto text_of = [&](char c) -> std::optional<std::string> {
    switch (c) {
      case 'n':
        return rt::escape_name(component.instance_name());
      case 't':
      case 'm':
        return rt::escape_name(component.type_name());
      case 'v':
        return rt::escape_name(component.version());
      case 'V':
        return rt::escape_name(component.vendor());
      case 'c':
        return rt::escape_name(component.category());
      case 'i':
        return rt::escape_name(properties.getProperty("implementation_id"));
      case 'N':
        return std::string(rt::number_suffix(component.instance_name()));
      case 'h':
        return rt::escape_name(value("os.hostname"));
      case 'M':
        return rt::escape_name(value("manager.name"));
      case 'p':
        return value("manager.pid");
      default:
        return std::nullopt;
    }
  };
  auto formats = base::split_list(properties.getProperty("naming.formats"));
  if (formats.size() > max_names) {
    base::log(base::Level::error, component.instance_name(), "naming.formats has {} names, expected at most {}: the others are left out",
              formats.size(), max_names);
    formats.resize(max_names);
  }
  for (const auto& format : formats) names.push_back(rt::expand_format(format, text_of));
  return names;
}

// Whatever is thrown on the way, by a naming policy of an author or for want of memory, leaves no component that is half made.
base::Result<RTObject_impl*> ManagerImpl::try_to_finish_creation(const Record& place, const rt::ComponentArgument& argument) {
  std::string problem = "an unknown exception";
  try {
    return finish_creation(place, argument);
  } catch (const std::exception& exception) {
    problem = exception.what();
  } catch (...) {
    RTC_DEBUG(("what was thrown is no std::exception"));
  }
  Held component;
  {
    auto locked = state.lock();
    if (const auto at = locked->records.find(place.id); at != locked->records.end()) {
      at->second.finalized = true;  // so that its end does not destroy it: its creator does
      component = manage(at->second.component);
    }
  }
  if (component) component->exit();
  return base::Error{problem};
}

base::Result<RTObject_impl*> ManagerImpl::finish_creation(const Record& place, const rt::ComponentArgument& argument) {
  const std::uint64_t id = place.id;
  const Held component = manage(state.lock()->records[id].component);
  // What counts more comes later: the manager's defaults, the type's specification, what rtc.conf and options set for all, rtc.conf on the
  // type, on the instance, the file that the argument names, the argument.
  coil::Properties properties = place.factory->profile();
  component->set_properties(properties);
  bool numbered = false;
  const auto name = name_component(*component, argument, numbered);
  {
    auto locked = state.lock();
    if (name) locked->records[id].instance_name = *name;
    locked->records[id].numbered = numbered;
  }
  if (!name) return name.error();
  component->set_instance_name(*name);
  const std::string category = component->category();
  const auto inherited = inherited_properties();
  for (const auto& key : inherited.propertyNames()) {
    const auto* own = properties.findNode(key);
    if (!where(key).empty() || own == nullptr || properties.getProperty(key).empty())
      properties.setProperty(key, inherited.getProperty(key));
  }
  properties << configured_properties(category, component->type_name());
  properties << configured_properties(category, *name);
  for (const auto& [key, text] : argument.properties) {
    if (key == "config_file") properties << properties_of_file("component " + base::in_quotes(*name) + ": config_file", text);
  }
  for (const auto& [key, text] : argument.properties) {
    if (is_directive(key)) continue;
    properties.setProperty(key, text);
    if (key == "exported_ports") properties.setProperty("conf.default.exported_ports", text);
  }
  properties.setProperty("instance_name", *name);
  listeners.rtclifecycle_.call(&RTM::RtcLifecycleActionListener::preConfigure, properties);
  const auto names = naming_names(*component, properties);
  properties.setProperty("naming.names", base::join(names, ","));
  component->set_properties(properties);
  listeners.rtclifecycle_.call(&RTM::RtcLifecycleActionListener::postConfigure, properties);

  listeners.rtclifecycle_.call(&RTM::RtcLifecycleActionListener::preInitialize);
  const auto code = component->initialize();
  listeners.rtclifecycle_.call(&RTM::RtcLifecycleActionListener::postInitialize);
  if (code != RTC_OK) {
    component->exit();
    return base::Error{"its initialisation failed"};
  }
  Record record;
  {
    auto locked = state.lock();
    auto& entry = locked->records[id];
    entry.listed = true;
    entry.names = names;
    entry.object_key = category + "." + *name;
    locked->had_components = true;
    record = entry;
  }
  publish(record);
  publish_ports(*component);
  subscribe_ports(*component);
  return component->object();
}

void ManagerImpl::publish(const Record& record) {
  coil::vstring names = record.names;
  listeners.naming_.call(&RTM::NamingActionListener::preBind, record.component, names);
  for (const auto& name : names) naming->bindObject(name.c_str(), record.component);
  RTObject_var reference = manage(record.component)->reference();
  if (orb && !CORBA::is_nil(reference)) orb->publish(record.object_key, reference);
  listeners.naming_.call(&RTM::NamingActionListener::postBind, record.component, names);
}

void ManagerImpl::withdraw(const Record& record) {
  if (!record.listed) return;
  coil::vstring names = record.names;
  listeners.naming_.call(&RTM::NamingActionListener::preUnbind, record.component, names);
  if (naming) {
    for (const auto& name : names) naming->unbindObject(name.c_str());
    for (const auto& name : record.port_names) naming->unbindObject(name.c_str());
  }
  if (orb) orb->withdraw(record.object_key);
  listeners.naming_.call(&RTM::NamingActionListener::postUnbind, record.component, names);
}

RTObject_impl* Manager::createComponent(const std::string& comp_args) {
  auto made = impl_->create(comp_args);
  if (made) return *made;
  impl_->report(made.error().message);
  return nullptr;
}

RTObject_impl* Manager::createComponent(const char* comp_args) {
  return createComponent(std::string(comp_args != nullptr ? comp_args : ""));
}

bool ManagerImpl::load_and_create(const std::string& module) {
  const bool is_argument = module.find('?') != std::string::npos || module.starts_with("RTC:");
  if (is_argument || find_factory(rt::ComponentId{{}, {}, module, {}, {}})) return facade.createComponent(module) != nullptr;
  if (facade.load(module) != RTC_OK) return false;
  const auto file = modules->findFile(module);
  std::vector<std::string> types;
  {
    auto known = state.lock();
    for (const auto& registered : known->factories) {
      if (registered.module == file) types.push_back(to_text(id_of(registered.factory->profile())));
    }
  }
  if (types.empty()) RTC_WARN(("module %s: registers no component", base::in_quotes(module).c_str()));
  bool ok = true;
  for (const auto& type : types) ok = facade.createComponent(type) != nullptr && ok;
  return ok;
}

}  // namespace RTC
