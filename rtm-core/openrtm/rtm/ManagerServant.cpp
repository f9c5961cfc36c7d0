#include "rtm/ManagerServant.h"

#include <algorithm>

#include "base/log.h"
#include "base/text.h"
#include "corba/orb.h"
#include "core/config_keys.h"
#include "rtm/LocalServiceAdmin.h"
#include "rtm/Manager.h"
#include "rtm/ManagerImpl.h"
#include "rtm/NVUtil.h"
#include "rtm/RTObject.h"

namespace RTM {
namespace {

constexpr std::size_t longest_name = std::size_t{64} << 10;
constexpr std::chrono::seconds peer_timeout{2};

template <class Sequence, class Element>
void append(Sequence& sequence, const Element& element) {
  const auto length = sequence.length();
  sequence.length(length + 1);
  sequence[length] = element;
}

template <class List, class Profile>
List* to_profiles(const std::vector<coil::Properties>& modules) {
  auto list = std::make_unique<List>();
  list->length(static_cast<CORBA::ULong>(modules.size()));
  for (CORBA::ULong i = 0; i < list->length(); ++i) NVUtil::copyFromProperties((*list)[i].properties, modules[i]);
  return list.release();
}

// Adds the reference unless an equivalent one is there.
bool add_unique(std::vector<RTM::Manager_var>& list, RTM::Manager_ptr manager) {
  for (const auto& known : list) {
    if (known->_is_equivalent(manager)) return false;
  }
  list.emplace_back(RTM::Manager::_duplicate(manager));
  return true;
}

RTM::ManagerList* to_list(const std::vector<RTM::Manager_var>& managers) {
  auto list = std::make_unique<RTM::ManagerList>();
  list->length(static_cast<CORBA::ULong>(managers.size()));
  for (CORBA::ULong i = 0; i < list->length(); ++i) (*list)[i] = RTM::Manager::_duplicate(managers[i].in());
  return list.release();
}

bool is_listed(const RTC::RTObject_impl& component, const std::string& category, const std::string& instance) {
  return instance == component.getInstanceName() && (category.empty() || category == "*" || category == component.getCategory());
}

}  // namespace

void ManagerServant::activate() {
  reference_ = _this();
  manager_.impl_->orb->publish(manager_.configValue("manager.name"), reference_);
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

// ---------------------------------------------------------------------------------------------- modules

RTC::ReturnCode_t ManagerServant::load_module(const char* pathname, const char* initfunc) { return manager_.load(pathname, initfunc); }
RTC::ReturnCode_t ManagerServant::unload_module(const char* pathname) { return manager_.unload(pathname); }

RTM::ModuleProfileList* ManagerServant::get_loadable_modules() {
  return to_profiles<RTM::ModuleProfileList, RTM::ModuleProfile>(manager_.getLoadableModules());
}
RTM::ModuleProfileList* ManagerServant::get_loaded_modules() {
  return to_profiles<RTM::ModuleProfileList, RTM::ModuleProfile>(manager_.getLoadedModules());
}
RTM::ModuleProfileList* ManagerServant::get_factory_profiles() {
  return to_profiles<RTM::ModuleProfileList, RTM::ModuleProfile>(manager_.getFactoryProfiles());
}

// ---------------------------------------------------------------------------------------------- components

RTC::RTObject_ptr ManagerServant::create_component(const char* module_name) {
  auto* component = manager_.createComponent(module_name);
  return component != nullptr ? component->getObjRef() : RTC::RTObject::_nil();
}

RTC::ReturnCode_t ManagerServant::delete_component(const char* instance_name) {
  const auto code = manager_.deleteComponent(instance_name);
  if (code != RTC::BAD_PARAMETER) return code;
  for (const auto& slave : living_slaves()) {
    try {
      if (slave->delete_component(instance_name) == RTC::RTC_OK) return RTC::RTC_OK;
    } catch (const CORBA::Exception&) {  // gone meanwhile
      continue;
    }
  }
  return RTC::BAD_PARAMETER;
}

RTC::RTCList* ManagerServant::get_components() {
  RTC::RTCList_var list = new RTC::RTCList;
  for (const auto* component : manager_.getComponents()) {
    RTC::RTObject_var reference = component->getObjRef();
    append(list.inout(), reference);
  }
  for (const auto& slave : living_slaves()) {
    try {
      RTC::RTCList_var theirs = slave->get_components();
      for (CORBA::ULong i = 0; i < theirs->length(); ++i) append(list.inout(), theirs[i]);
    } catch (const CORBA::Exception&) {  // gone meanwhile
      continue;
    }
  }
  return list._retn();
}

RTC::ComponentProfileList* ManagerServant::get_component_profiles() {
  RTC::ComponentProfileList_var list = new RTC::ComponentProfileList;
  for (auto* component : manager_.getComponents()) {
    RTC::ComponentProfile_var profile = component->get_component_profile();
    append(list.inout(), profile.in());
  }
  for (const auto& slave : living_slaves()) {
    try {
      RTC::ComponentProfileList_var theirs = slave->get_component_profiles();
      for (CORBA::ULong i = 0; i < theirs->length(); ++i) append(list.inout(), theirs[i]);
    } catch (const CORBA::Exception&) {  // gone meanwhile
      continue;
    }
  }
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
  for (const auto* component : manager_.getComponents()) {
    if (!is_listed(*component, category, instance)) continue;
    RTC::RTObject_var reference = component->getObjRef();
    append(list.inout(), reference);
  }
  return list._retn();
}

// ---------------------------------------------------------------------------------------------- settings

RTM::ManagerProfile* ManagerServant::get_profile() {
  RTM::ManagerProfile_var profile = new RTM::ManagerProfile;
  coil::Properties node;
  {
    const std::scoped_lock lock(manager_.impl_->config_mutex);
    node = manager_.impl_->config.getNode("manager");
  }
  NVUtil::copyFromProperties(profile->properties, node);
  return profile._retn();
}

RTM::NVList* ManagerServant::get_configuration() {
  RTM::NVList_var list = new RTM::NVList;
  coil::Properties config;
  {
    const std::scoped_lock lock(manager_.impl_->config_mutex);
    config = manager_.impl_->config;
  }
  NVUtil::copyFromProperties(list.inout(), config);
  return list._retn();
}

RTC::ReturnCode_t ManagerServant::set_configuration(const char* name, const char* value) {
  const std::string key(base::trim(name));
  if (key.empty() || key.size() > 1024 || std::string_view(value).size() > longest_name || key.front() == '.' || key.back() == '.' ||
      key.find("..") != std::string::npos) {
    return RTC::BAD_PARAMETER;
  }
  const auto complaint = rt::complain_about(key, value);
  if (complaint && !complaint->starts_with("unknown key")) return RTC::BAD_PARAMETER;
  const std::scoped_lock lock(manager_.impl_->config_mutex);
  manager_.impl_->config.setProperty(key, value);
  return RTC::RTC_OK;
}

// ---------------------------------------------------------------------------------------------- masters and slaves

CORBA::Boolean ManagerServant::is_master() { return manager_.impl_->is_master(); }

RTM::ManagerList* ManagerServant::get_master_managers() {
  const std::scoped_lock lock(mutex_);
  return to_list(masters_);
}

RTC::ReturnCode_t ManagerServant::add_master_manager(RTM::Manager_ptr mgr) {
  if (CORBA::is_nil(mgr) || mgr->_is_equivalent(reference_)) return RTC::BAD_PARAMETER;
  const std::scoped_lock lock(mutex_);
  return add_unique(masters_, mgr) ? RTC::RTC_OK : RTC::BAD_PARAMETER;
}

RTC::ReturnCode_t ManagerServant::remove_master_manager(RTM::Manager_ptr mgr) {
  if (CORBA::is_nil(mgr)) return RTC::BAD_PARAMETER;
  const std::scoped_lock lock(mutex_);
  return std::erase_if(masters_, [&](const auto& known) { return known->_is_equivalent(mgr); }) > 0 ? RTC::RTC_OK : RTC::BAD_PARAMETER;
}

RTM::ManagerList* ManagerServant::get_slave_managers() { return to_list(living_slaves()); }

RTC::ReturnCode_t ManagerServant::add_slave_manager(RTM::Manager_ptr mgr) {
  if (CORBA::is_nil(mgr) || mgr->_is_equivalent(reference_)) return RTC::BAD_PARAMETER;
  const std::scoped_lock lock(mutex_);
  return add_unique(slaves_, mgr) ? RTC::RTC_OK : RTC::BAD_PARAMETER;
}

RTC::ReturnCode_t ManagerServant::remove_slave_manager(RTM::Manager_ptr mgr) {
  if (CORBA::is_nil(mgr)) return RTC::BAD_PARAMETER;
  const std::scoped_lock lock(mutex_);
  return std::erase_if(slaves_, [&](const auto& known) { return known->_is_equivalent(mgr); }) > 0 ? RTC::RTC_OK : RTC::BAD_PARAMETER;
}

// The slaves that answer; the others are forgotten.
std::vector<RTM::Manager_var> ManagerServant::living_slaves() {
  std::vector<RTM::Manager_var> slaves;
  {
    const std::scoped_lock lock(mutex_);
    slaves = slaves_;
  }
  std::vector<RTM::Manager_var> living;
  for (auto& slave : slaves) {
    try {
      corba::set_call_timeout(slave, peer_timeout);
      if (!slave->_non_existent()) {
        living.push_back(slave);
        continue;
      }
    } catch (const CORBA::Exception&) {  // as good as gone
    }
    remove_slave_manager(slave);
  }
  return living;
}

void ManagerServant::greet_master() {
  const auto url = "corbaloc:iiop:" + manager_.configValue("corba.master_manager") + "/" + manager_.configValue("manager.name");
  try {
    CORBA::Object_var object = manager_.getORB()->string_to_object(url.c_str());
    corba::set_call_timeout(object, peer_timeout);
    RTM::Manager_var master = RTM::Manager::_narrow(object);
    if (CORBA::is_nil(master) || master->_is_equivalent(reference_)) return;
    corba::set_call_timeout(master, peer_timeout);
    {
      const std::scoped_lock lock(mutex_);
      masters_.clear();
      masters_.push_back(master);
    }
    master->add_slave_manager(reference_);  // BAD_PARAMETER: it knows us
  } catch (const CORBA::Exception&) {       // no master now
    const std::scoped_lock lock(mutex_);
    masters_.clear();
  }
}

void ManagerServant::leave_masters() {
  std::vector<RTM::Manager_var> masters;
  std::vector<RTM::Manager_var> slaves;
  {
    const std::scoped_lock lock(mutex_);
    masters.swap(masters_);
    slaves.swap(slaves_);
  }
  const auto quietly = [](auto&& call) {
    try {
      call();
    } catch (const CORBA::Exception&) {  // it has gone before us
    }
  };
  for (auto& master : masters) {
    corba::set_call_timeout(master, peer_timeout);
    quietly([&] { master->remove_slave_manager(reference_); });
  }
  for (auto& slave : slaves) {
    corba::set_call_timeout(slave, peer_timeout);
    quietly([&] { slave->remove_master_manager(reference_); });
  }
}

// ---------------------------------------------------------------------------------------------- the process

// A copy of a process with threads, connections and devices is nothing anybody could use.
RTC::ReturnCode_t ManagerServant::fork() { return RTC::UNSUPPORTED; }
RTC::ReturnCode_t ManagerServant::restart() { return RTC::UNSUPPORTED; }

RTC::ReturnCode_t ManagerServant::shutdown() {
  manager_.terminate();
  return RTC::RTC_OK;
}

CORBA::Object_ptr ManagerServant::get_service(const char*) { return CORBA::Object::_nil(); }

}  // namespace RTM
