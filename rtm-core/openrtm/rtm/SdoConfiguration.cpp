#include "rtm/SdoConfiguration.h"

#include <rtm/ConfigAdmin.h>
#include <rtm/NVUtil.h>
#include <rtm/RTObject.h>
#include <rtm/SdoServiceAdmin.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "base/guarded.h"
#include "base/text.h"
#include "base/tick.h"
#include "component/runtime_access.h"
#include "corba/orb/gate.h"
#include "corba/orb/nv_list.h"
#include "core/key_limits.h"

namespace SDOPackage {

namespace {

void check_id(const char* what, const char* id) {
  if (id[0] == '\0') throw InvalidParameter((std::string(what) + " is empty").c_str());
  if (auto checked = rt::check_key(what, id); !checked) throw InvalidParameter(checked.error().message.c_str());
}

void check_names(const char* what, const NVList& list) {
  if (auto checked = corba::check_keys(what, list); !checked) throw InvalidParameter(checked.error().message.c_str());
}

class Inside {
 public:
  explicit Inside(corba::Gate& gate) : visit_(gate) {
    if (!visit_) throw CORBA::OBJECT_NOT_EXIST();
  }

 private:
  corba::Gate::Visit visit_;
  const base::OutsideTicks outside_;
};

coil::Properties to_properties(const ConfigurationSet& set) {
  check_id("id of the configuration set", set.id);
  check_names("configuration parameter", set.configuration_data);
  for (CORBA::ULong i = 0; i < set.configuration_data.length(); ++i)
    check_id("name of a configuration parameter", set.configuration_data[i].name);
  coil::Properties node(set.id.in());
  NVUtil::copyToProperties(node, set.configuration_data);
  if (set.description.in()[0] != '\0') node.setProperty("description", set.description.in());
  return node;
}

ConfigurationSet to_set(const coil::Properties& node) {
  ConfigurationSet set;
  set.id = node.getName();
  set.description = node.getProperty("description").c_str();
  NVUtil::copyFromProperties(set.configuration_data, node);
  return set;
}

}  // namespace

// Changes come one after another, so listeners of sets are not called by two callers at once. A listener may make further changes.
struct Configuration_impl::Door {
  corba::Gate gate;
  base::UsersTurn turn;

  // Throws if a listener that another caller's change has called does not return in time.
  base::UsersTurn::Mine turn_to_change(std::chrono::nanoseconds timeout) {
    auto mine = turn.take(std::max<std::chrono::nanoseconds>(timeout, std::chrono::seconds(1)));
    if (!mine) throw InternalError("another change of the configuration has not ended: a listener does not return");
    return std::move(*mine);
  }
};

Configuration_impl::Configuration_impl(RTC::RTObject_impl& component, RTC::ConfigAdmin& configuration, RTC::SdoServiceAdmin& services)
    : door_(std::make_unique<Door>()), component_(component), configuration_(configuration), services_(services) {}

Configuration_impl::~Configuration_impl() = default;

void Configuration_impl::close() { door_->gate.close(); }

CORBA::Boolean Configuration_impl::set_device_profile(const DeviceProfile& profile) {
  const Inside inside(door_->gate);
  check_names("property of the device", profile.properties);
  component_.setDeviceProfile(profile);
  return true;
}

CORBA::Boolean Configuration_impl::add_service_profile(const ServiceProfile& profile) {
  const Inside inside(door_->gate);
  if (profile.id.in()[0] != '\0') check_id("id of the service", profile.id);
  check_names("property of the service", profile.properties);
  return services_.addSdoServiceConsumer(profile);
}

CORBA::Boolean Configuration_impl::add_organization(Organization_ptr organization) {
  const Inside inside(door_->gate);
  if (CORBA::is_nil(organization)) throw InvalidParameter("the organization is nil");
  return RTC::RuntimeAccess::add_organization(component_, organization);
}

CORBA::Boolean Configuration_impl::remove_service_profile(const char* id) {
  const Inside inside(door_->gate);
  if (id[0] == '\0') throw InvalidParameter("the id is empty");
  return services_.removeSdoServiceConsumer(id);
}

CORBA::Boolean Configuration_impl::remove_organization(const char* organization_id) {
  const Inside inside(door_->gate);
  if (organization_id[0] == '\0') throw InvalidParameter("the id is empty");
  return RTC::RuntimeAccess::remove_organization(component_, organization_id);
}

ParameterList* Configuration_impl::get_configuration_parameters() { return new ParameterList(); }

NVList* Configuration_impl::get_configuration_parameter_values() { return new NVList(); }

CORBA::Any* Configuration_impl::get_configuration_parameter_value(const char* name) {
  if (name[0] == '\0') throw InvalidParameter("the name is empty");
  return new CORBA::Any();
}

CORBA::Boolean Configuration_impl::set_configuration_parameter(const char* name, const CORBA::Any&) {
  if (name[0] == '\0') throw InvalidParameter("the name is empty");
  return true;
}

ConfigurationSetList* Configuration_impl::get_configuration_sets() {
  const Inside inside(door_->gate);
  const std::vector<coil::Properties> nodes = configuration_.getConfigurationSets();
  ConfigurationSetList_var sets = new ConfigurationSetList();
  sets->length(static_cast<CORBA::ULong>(nodes.size()));
  for (CORBA::ULong i = 0; i < sets->length(); ++i) sets[i] = to_set(nodes[i]);
  return sets._retn();
}

ConfigurationSet* Configuration_impl::get_configuration_set(const char* id) {
  const Inside inside(door_->gate);
  if (!configuration_.haveConfig(id)) throw InternalError(("no configuration set " + base::in_quotes(id)).c_str());
  return new ConfigurationSet(to_set(configuration_.getConfigurationSet(id)));
}

CORBA::Boolean Configuration_impl::set_configuration_set_values(const ConfigurationSet& set) {
  const Inside inside(door_->gate);
  const auto mine = door_->turn_to_change(RTC::RuntimeAccess::callback_timeout(component_));
  return configuration_.setConfigurationSetValues(to_properties(set));
}

ConfigurationSet* Configuration_impl::get_active_configuration_set() {
  const Inside inside(door_->gate);
  if (!configuration_.isActive()) throw NotAvailable("a set has changed and none has been activated since");
  return new ConfigurationSet(to_set(configuration_.getActiveConfigurationSet()));
}

CORBA::Boolean Configuration_impl::add_configuration_set(const ConfigurationSet& set) {
  const Inside inside(door_->gate);
  const auto mine = door_->turn_to_change(RTC::RuntimeAccess::callback_timeout(component_));
  return configuration_.addConfigurationSet(to_properties(set));
}

CORBA::Boolean Configuration_impl::remove_configuration_set(const char* id) {
  const Inside inside(door_->gate);
  const auto mine = door_->turn_to_change(RTC::RuntimeAccess::callback_timeout(component_));
  if (id[0] == '\0') throw InvalidParameter("the id is empty");
  return configuration_.removeConfigurationSet(id);
}

CORBA::Boolean Configuration_impl::activate_configuration_set(const char* id) {
  const Inside inside(door_->gate);
  const auto mine = door_->turn_to_change(RTC::RuntimeAccess::callback_timeout(component_));
  if (id[0] == '\0') throw InvalidParameter("the id is empty");
  if (!configuration_.activateConfigurationSet(id))
    throw InvalidParameter(("no configuration set " + base::in_quotes(id) + " that can be active").c_str());
  return true;
}

}  // namespace SDOPackage
