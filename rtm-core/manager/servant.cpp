// The manager as tools see it.
//
// A manager makes components itself; a master also shows those of its slaves and asks them for what it cannot make. It never starts a
// process. Masters and slaves are in servant_family.cpp. fork and restart answer RTC_OK and do nothing, as everywhere.
#include "rtm/ManagerServant.h"

#include "base/log.h"
#include "base/text.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/guarded_transport.h"
#include "corba/orb/orb.h"
#include "corba/orb/principal.h"
#include "corba/orb/sequences.h"
#include "core/component_argument.h"
#include "core/config_keys.h"
#include "core/key_limits.h"
#include "core/remote_rights.h"
#include "manager/at_once.h"
#include "manager/manager_impl.h"
#include "rtm/LocalServiceAdmin.h"
#include "rtm/Manager.h"
#include "rtm/NVUtil.h"

namespace RTM {
namespace {

constexpr std::size_t longest_name = std::size_t{64} << 10;
constexpr std::chrono::seconds creation_timeout{10};
constexpr std::chrono::seconds deletion_timeout{2};  // of one slave
constexpr std::chrono::seconds modules_timeout{30};  // each module is read in a process of its own

// The reference is nil when the component has just been finalized.
void append_component(RTC::RTCList& list, const RTC::Managed& component) {
  RTC::RTObject_var reference = component.reference();
  if (!CORBA::is_nil(reference)) corba::append(list, reference);
}

RTM::ModuleProfileList_var to_profiles(const std::vector<coil::Properties>& modules) {
  RTM::ModuleProfileList_var list = new RTM::ModuleProfileList;
  list->length(static_cast<CORBA::ULong>(modules.size()));
  for (CORBA::ULong i = 0; i < list->length(); ++i) NVUtil::copyFromProperties(list[i].properties, modules[i]);
  return list;
}

struct Request {
  std::string argument;         // without the two below
  std::string manager_name;     // empty: any
  std::string manager_address;  // host:port; empty: here
};

Request take_manager(const std::string& text) {
  Request request;
  const auto question = text.find('?');
  request.argument = text.substr(0, question);
  if (question == std::string::npos) return request;
  std::vector<std::string> rest;
  for (auto& piece : base::split_list(std::string_view(text).substr(question + 1), '&')) {
    const auto equals = piece.find('=');
    const auto key = base::trim(std::string_view(piece).substr(0, equals));
    const auto value = equals == std::string::npos ? std::string_view() : base::trim(std::string_view(piece).substr(equals + 1));
    if (key == "manager_name") {
      request.manager_name = value;
    } else if (key == "manager_address") {
      request.manager_address = value;
    } else {
      rest.push_back(std::move(piece));
    }
  }
  if (!rest.empty()) request.argument += "?" + base::join(rest, "&");
  return request;
}

RTC::RTObject_ptr create_at(RTM::Manager_ptr manager, const std::string& argument) {
  try {
    RTM::Manager_var patient = RTM::Manager::_duplicate(manager);
    corba::set_call_timeout(patient, creation_timeout);
    return patient->create_component(argument.c_str());
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::error, "manager", "component {}: another manager fails: {}", base::in_quotes(argument), corba::to_text(e));
    return RTC::RTObject::_nil();
  }
}

std::string name_of(RTM::Manager_ptr manager) {
  try {
    RTM::ManagerProfile_var profile = manager->get_profile();
    return NVUtil::toString(profile->properties, "instance_name");
  } catch (const CORBA::Exception&) {  // as good as nameless
    return {};
  }
}

bool is_listed(const RTC::Managed& component, const std::string& category, const std::string& instance) {
  return instance == component.instance_name() && (category.empty() || category == "*" || category == component.category());
}

}  // namespace

void ManagerServant::activate() {
  reference_ = _this();
  manager_.impl_->orb->publish(manager_.configValue("manager.name"), reference_);
}

bool ManagerServant::createINSManager() {
  try {
    if (CORBA::is_nil(reference_)) activate();
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::warn, "manager", "the manager's object cannot be made: {}", corba::to_text(e));
  }
  return !CORBA::is_nil(reference_);
}

void ManagerServant::deactivate() {
  try {
    manager_.impl_->orb->withdraw(manager_.configValue("manager.name"));
    const PortableServer::POA_var poa = _default_POA();
    const PortableServer::ObjectId_var id = poa->servant_to_id(this);
    poa->deactivate_object(id);
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::warn, "manager", "taking the manager's object away failed: {}", corba::to_text(e));
  }
}

// --- who may do what

// rtc.conf says it, and nobody over the wire.
bool ManagerServant::may_do_everything() const {
  return rt::parse_remote_rights(manager_.configValue("manager.remote_rights")) == rt::RemoteRights::everything;
}

bool ManagerServant::may_change(const std::string& what, bool needs_everything) const {
  const auto given = rt::parse_remote_rights(manager_.configValue("manager.remote_rights"));
  if (given >= (needs_everything ? rt::RemoteRights::everything : rt::RemoteRights::components)) return true;
  refuse(what, given == rt::RemoteRights::read ? "manager.remote_rights is read" : "manager.remote_rights is not everything");
  return false;
}

void ManagerServant::refuse(const std::string& what, const std::string& why) const {
  if (const auto left_out = manager_.impl_->rejection_limiter.next())
    base::log(base::Level::warn, "manager", "{} asked for {}: rejected, {}{}", corba::caller(), what, why,
              rt::LogRateLimiter::omitted_text(*left_out));
}

// --- modules

// Whoever may put a file somewhere would be this account. A module of the load path was put there by somebody who is.
bool ManagerServant::may_load(const std::string& module, const std::string& what) const {
  const bool is_said = !manager_.impl_->where("manager.modules.abs_path_allowed").empty() || may_do_everything();
  if (module.find('/') == std::string::npos || !corba::accepts_other_accounts() || is_said) return true;
  refuse(what, "others than the own account may call and manager.modules.abs_path_allowed is not set");
  return false;
}

bool ManagerServant::may_set(const std::string& key, const std::string& value, const std::string& what) const {
  const bool is_shown = corba::principal() != corba::Principal::own && rt::shows_environment(key, value);
  return may_change(what, rt::is_protected_key(key) || is_shown);
}

RTC::ReturnCode_t ManagerServant::load_module(const char* pathname, const char* initfunc) {
  const std::string path(pathname);
  const std::string what = "the module " + base::in_quotes(path);
  if (!may_change(what)) return RTC::RTC_ERROR;
  if (!may_load(path, what)) return RTC::RTC_ERROR;
  const std::string suffix = manager_.configValue("manager.modules.init_func_suffix");
  if (!may_do_everything() &&
      !rt::is_init_function(path, initfunc, manager_.configValue("manager.modules.init_func_prefix"), suffix.empty() ? "Init" : suffix)) {
    refuse(what + " by the function " + base::in_quotes(initfunc), "no function that makes a module known has that name");
    return RTC::BAD_PARAMETER;
  }
  return manager_.load(pathname, initfunc);
}

RTC::ReturnCode_t ManagerServant::unload_module(const char* pathname) {
  if (!may_change("the end of module " + base::in_quotes(pathname))) return RTC::RTC_ERROR;
  return manager_.unload(pathname);
}

// What every living slave answers, appended. All are asked at the same time. One that takes the time-out is dropped: nobody waits for it
// twice.
template <class List, class Ask>
void ManagerServant::append_from_slaves(List& list, Ask ask) {
  const auto slaves = living_slaves();
  std::vector<std::optional<decltype(ask(slaves.front().in()))>> answers(slaves.size());
  at_once(slaves.size(), [&](std::size_t i) {
    try {
      answers[i].emplace(ask(slaves[i].in()));
    } catch (const CORBA::Exception& e) {  // gone meanwhile, or hanging
      if (corba::is_time_out(e)) drop(slaves[i], true);
    }
  });
  for (auto& theirs : answers) {
    for (CORBA::ULong i = 0; theirs && i < (*theirs)->length(); ++i) corba::append(list, (*theirs)[i]);
  }
}

RTM::ModuleProfileList* ManagerServant::get_loadable_modules() {
  auto list = to_profiles(manager_.getLoadableModules());
  append_from_slaves(list.inout(), [](RTM::Manager_ptr slave) {
    corba::set_call_timeout(slave, modules_timeout);
    return RTM::ModuleProfileList_var(slave->get_loadable_modules());
  });
  return list._retn();
}

RTM::ModuleProfileList* ManagerServant::get_loaded_modules() {
  auto list = to_profiles(manager_.getLoadedModules());
  append_from_slaves(list.inout(), [](RTM::Manager_ptr slave) { return RTM::ModuleProfileList_var(slave->get_loaded_modules()); });
  return list._retn();
}

RTM::ModuleProfileList* ManagerServant::get_factory_profiles() {
  auto list = to_profiles(manager_.getFactoryProfiles());
  append_from_slaves(list.inout(), [](RTM::Manager_ptr slave) { return RTM::ModuleProfileList_var(slave->get_factory_profiles()); });
  return list._retn();
}

// --- components

// Here, unless the argument names another manager: manager_address=host:port any, manager_name=instance name a slave. Slaves are also asked
// for what cannot be made here.
RTC::RTObject_ptr ManagerServant::create_component(const char* module_name) {
  if (!may_change("the component " + base::in_quotes(module_name))) return RTC::RTObject::_nil();
  const auto [argument, name, address] = take_manager(module_name);
  const auto wanted = rt::parse_component_argument(argument);
  for (const auto& [key, text] : wanted ? wanted->properties : decltype(wanted->properties){}) {
    if (!may_set(key, text, "a component with " + base::in_quotes(key))) return RTC::RTObject::_nil();
  }
  // A type that is not known yet is looked for as a module of that name.
  if (!may_load(argument.substr(0, argument.find('?')), "the component " + base::in_quotes(argument))) return RTC::RTObject::_nil();
  // The other one would see a caller of our account.
  if (!address.empty() && corba::accepts_other_accounts() && !may_change("a component at another manager", true))
    return RTC::RTObject::_nil();
  if (!address.empty()) {
    RTM::Manager_var other = manager_at(address);
    if (CORBA::is_nil(other)) {
      base::log(base::Level::error, "manager", "component {}: no manager answers at {}", base::in_quotes(argument),
                base::in_quotes(address));
      return RTC::RTObject::_nil();
    }
    return create_at(other, argument);
  }
  const auto slaves = living_slaves();
  if (!name.empty() && name != manager_.configValue("manager.instance_name")) {
    std::vector<std::string> names(slaves.size());
    at_once(slaves.size(), [&](std::size_t i) { names[i] = name_of(slaves[i]); });
    const auto wanted_slave = std::ranges::find(names, name);
    if (wanted_slave != names.end()) return create_at(slaves[static_cast<std::size_t>(wanted_slave - names.begin())], argument);
  }
  if (auto* made = manager_.createComponent(argument)) {
    const auto component = manager_.impl_->held_component(made);
    return component ? component->reference() : RTC::RTObject::_nil();
  }
  const auto parsed = rt::parse_component_argument(argument);
  if (!parsed || manager_.impl_->find_factory(parsed->id)) return RTC::RTObject::_nil();  // it can be made here, but fails
  for (const auto& slave : slaves) {
    RTC::RTObject_var made = create_at(slave, argument);
    if (!CORBA::is_nil(made)) return made._retn();
  }
  return RTC::RTObject::_nil();
}

RTC::ReturnCode_t ManagerServant::delete_component(const char* instance_name) {
  if (!may_change("the end of component " + base::in_quotes(instance_name))) return RTC::RTC_ERROR;
  const auto code = manager_.deleteComponent(instance_name);
  if (code != RTC::BAD_PARAMETER) return code;
  const corba::ChainDeadline deadline(deletion_timeout);
  for (const auto& slave : living_slaves()) {
    if (deadline.is_over()) break;
    try {
      deadline.limit(slave);
      if (slave->delete_component(instance_name) == RTC::RTC_OK) return RTC::RTC_OK;
    } catch (const CORBA::Exception& e) {  // gone meanwhile, or hanging
      if (corba::is_time_out(e)) drop(slave, true);
    }
  }
  return RTC::BAD_PARAMETER;
}

RTC::RTCList* ManagerServant::get_components() {
  RTC::RTCList_var list = new RTC::RTCList;
  for (const auto& component : manager_.impl_->held_components()) append_component(list.inout(), *component);
  append_from_slaves(list.inout(), [](RTM::Manager_ptr slave) { return RTC::RTCList_var(slave->get_components()); });
  return list._retn();
}

RTC::ComponentProfileList* ManagerServant::get_component_profiles() {
  RTC::ComponentProfileList_var list = new RTC::ComponentProfileList;
  for (const auto& component : manager_.impl_->held_components()) {
    RTC::ComponentProfile_var profile = component->profile();
    corba::append(list.inout(), profile.in());
  }
  append_from_slaves(list.inout(), [](RTM::Manager_ptr slave) { return RTC::ComponentProfileList_var(slave->get_component_profiles()); });
  return list._retn();
}

// `instance`, `category/instance` or `*/instance`.
RTC::RTCList* ManagerServant::get_components_by_name(const char* name) {
  RTC::RTCList_var list = new RTC::RTCList;
  const std::string text(name);
  if (text.size() > longest_name) return list._retn();
  const auto slash = text.rfind('/');
  const auto category = slash == std::string::npos ? std::string() : text.substr(0, slash);
  const auto instance = slash == std::string::npos ? text : text.substr(slash + 1);
  for (const auto& component : manager_.impl_->held_components()) {
    if (is_listed(*component, category, instance)) append_component(list.inout(), *component);
  }
  return list._retn();
}

// --- settings

RTM::ManagerProfile* ManagerServant::get_profile() {
  RTM::ManagerProfile_var profile = new RTM::ManagerProfile;
  coil::Properties node;
  {
    const auto mine = manager_.impl_->config_turn.take();
    node = manager_.impl_->config.getNode("manager");
  }
  NVUtil::copyFromProperties(profile->properties, node);
  return profile._retn();
}

RTM::NVList* ManagerServant::get_configuration() {
  RTM::NVList_var list = new RTM::NVList;
  coil::Properties config;
  {
    const auto mine = manager_.impl_->config_turn.take();
    config = manager_.impl_->config;
  }
  if (corba::principal() != corba::Principal::own) {
    for (const auto& key : config.propertyNames()) {
      if (rt::is_secret_key(key)) config.setProperty(key, "");
    }
  }
  NVUtil::copyFromProperties(list.inout(), config);
  return list._retn();
}

RTC::ReturnCode_t ManagerServant::set_configuration(const char* name, const char* value) {
  const std::string key(base::trim(name));
  if (key.empty() || !rt::check_key("key", key) || std::string_view(value).size() > longest_name || key.front() == '.' ||
      key.back() == '.' || key.find("..") != std::string::npos) {
    return RTC::BAD_PARAMETER;
  }
  if (!may_set(key, value, "the key " + base::in_quotes(key))) return RTC::RTC_ERROR;
  const auto complaint = rt::complain_about(key, value);
  if (complaint && !complaint->takes_value) return RTC::BAD_PARAMETER;
  bool has_room = false;
  {
    const auto mine = manager_.impl_->config_turn.take();
    has_room = manager_.impl_->keys_of_callers.take(key, value);
    if (has_room) manager_.impl_->config.setProperty(key, value);
  }
  if (!has_room) {
    base::log(base::Level::error, "manager", "key {} is rejected: callers can set {} keys, and {} bytes with their values",
              base::in_quotes(key), rt::entry_limits.manager_keys, rt::entry_limits.manager_octets);
    return RTC::OUT_OF_RESOURCES;
  }
  if (key.starts_with("logger.")) manager_.impl_->start_logging();
  return RTC::RTC_OK;
}

// --- the process

// Nothing happens, as tools know it from every manager: neither a copy nor a new start of a process with threads and devices is possible.
RTC::ReturnCode_t ManagerServant::fork() { return RTC::RTC_OK; }
RTC::ReturnCode_t ManagerServant::restart() { return RTC::RTC_OK; }

RTC::ReturnCode_t ManagerServant::shutdown() {
  if (!may_change("the end of this process")) return RTC::RTC_ERROR;
  manager_.terminate();
  return RTC::RTC_OK;
}

CORBA::Object_ptr ManagerServant::get_service(const char*) { return CORBA::Object::_nil(); }

}  // namespace RTM
