#include "rtm/CORBA_RTCUtil.h"

#include <algorithm>

#include "base/log.h"
#include "base/text.h"
#include "corba/orb/orb.h"
#include "rtm/Manager.h"
#include "rtm/NVUtil.h"
#include "rtm/NamingManager.h"

namespace CORBA_RTCUtil {
namespace {

using RTC::BAD_PARAMETER;
using RTC::RTC_ERROR;
using RTC::RTC_OK;

constexpr UniqueId first_participating = 1000;

// What the call returns, or `otherwise` with a log line when the peer does not answer as it should.
template <class Result, class Call>
Result guarded(Result otherwise, Call&& call) {
  try {
    return call();
  } catch (const CORBA::Exception& e) {
    base::log(base::Level::warn, "rtcutil", "a call to another component failed: {}", corba::to_text(e));
  }
  return otherwise;
}

RTC::ExecutionContextService_ptr service_of(const RTC::RTObject_ptr rtc, UniqueId ec_id) {
  RTC::ExecutionContext_var ec = get_actual_ec(rtc, ec_id);
  return CORBA::is_nil(ec) ? RTC::ExecutionContextService::_nil() : RTC::ExecutionContextService::_narrow(ec);
}

std::string name_of(const RTC::PortService_ptr port) {
  RTC::PortProfile_var profile = port->get_port_profile();
  return profile->name.in();
}

// Names of the ports with that port.port_type; all if it is empty.
coil::vstring port_names(const RTC::RTObject_ptr rtc, const std::string& type) {
  if (CORBA::is_nil(rtc)) return {};
  return guarded(coil::vstring(), [&] {
    coil::vstring names;
    RTC::PortServiceList_var ports = rtc->get_ports();
    for (CORBA::ULong i = 0; i < ports->length(); ++i) {
      RTC::PortProfile_var profile = ports[i]->get_port_profile();
      if (type.empty() || NVUtil::toString(profile->properties, "port.port_type") == type) names.emplace_back(profile->name.in());
    }
    return names;
  });
}

template <class Choose>
coil::vstring connectors_of(const RTC::PortService_ptr port, Choose choose) {
  if (CORBA::is_nil(port)) return {};
  return guarded(coil::vstring(), [&] {
    coil::vstring result;
    RTC::ConnectorProfileList_var profiles = port->get_connector_profiles();
    for (CORBA::ULong i = 0; i < profiles->length(); ++i) result.emplace_back(choose(profiles[i]));
    return result;
  });
}

}  // namespace

// --- components and contexts

coil::Properties get_component_profile(const RTC::RTObject_ptr rtc) {
  if (CORBA::is_nil(rtc)) return {};
  return guarded(coil::Properties(), [&] {
    RTC::ComponentProfile_var profile = rtc->get_component_profile();
    coil::Properties properties;
    NVUtil::copyToProperties(properties, profile->properties);
    return properties;
  });
}

bool is_existing(const RTC::RTObject_ptr rtc) {
  try {
    return !CORBA::is_nil(rtc) && !rtc->_non_existent();
  } catch (const CORBA::Exception&) {
    return false;
  }
}

bool is_alive_in_default_ec(const RTC::RTObject_ptr rtc) {
  RTC::ExecutionContext_var ec = get_actual_ec(rtc, 0);
  if (CORBA::is_nil(ec)) return false;
  return guarded(false, [&] { return static_cast<bool>(rtc->is_alive(ec)); });
}

RTC::ExecutionContext_ptr get_actual_ec(const RTC::RTObject_ptr rtc, UniqueId ec_id) {
  if (CORBA::is_nil(rtc) || ec_id < 0) return RTC::ExecutionContext::_nil();
  return guarded(RTC::ExecutionContext::_nil(), [&] {
    const bool is_owned = ec_id < first_participating;
    RTC::ExecutionContextList_var list = is_owned ? rtc->get_owned_contexts() : rtc->get_participating_contexts();
    const auto index = static_cast<CORBA::ULong>(is_owned ? ec_id : ec_id - first_participating);
    return index < list->length() ? RTC::ExecutionContext::_duplicate(list[index]) : RTC::ExecutionContext::_nil();
  });
}

UniqueId get_ec_id(const RTC::RTObject_ptr rtc, const RTC::ExecutionContext_ptr ec) {
  if (CORBA::is_nil(rtc) || CORBA::is_nil(ec)) return -1;
  return guarded(UniqueId{-1}, [&]() -> UniqueId {
    const auto index_in = [&](const RTC::ExecutionContextList& list) -> UniqueId {
      for (CORBA::ULong i = 0; i < list.length(); ++i) {
        if (!CORBA::is_nil(list[i]) && list[i]->_is_equivalent(ec)) return static_cast<UniqueId>(i);
      }
      return -1;
    };
    RTC::ExecutionContextList_var owned = rtc->get_owned_contexts();
    if (const auto index = index_in(owned); index >= 0) return index;
    RTC::ExecutionContextList_var others = rtc->get_participating_contexts();
    const auto index = index_in(others);
    return index >= 0 ? first_participating + index : -1;
  });
}

ReturnCode_t activate(const RTC::RTObject_ptr rtc, UniqueId ec_id) {
  RTC::ExecutionContext_var ec = get_actual_ec(rtc, ec_id);
  return CORBA::is_nil(ec) ? BAD_PARAMETER : guarded(RTC_ERROR, [&] { return ec->activate_component(rtc); });
}

ReturnCode_t deactivate(const RTC::RTObject_ptr rtc, UniqueId ec_id) {
  RTC::ExecutionContext_var ec = get_actual_ec(rtc, ec_id);
  return CORBA::is_nil(ec) ? BAD_PARAMETER : guarded(RTC_ERROR, [&] { return ec->deactivate_component(rtc); });
}

ReturnCode_t reset(const RTC::RTObject_ptr rtc, UniqueId ec_id) {
  RTC::ExecutionContext_var ec = get_actual_ec(rtc, ec_id);
  return CORBA::is_nil(ec) ? BAD_PARAMETER : guarded(RTC_ERROR, [&] { return ec->reset_component(rtc); });
}

bool get_state(RTC::LifeCycleState& state, const RTC::RTObject_ptr rtc, UniqueId ec_id) {
  RTC::ExecutionContext_var ec = get_actual_ec(rtc, ec_id);
  if (CORBA::is_nil(ec)) return false;
  return guarded(false, [&] {
    state = ec->get_component_state(rtc);
    return true;
  });
}

namespace {
bool is_in(RTC::LifeCycleState wanted, const RTC::RTObject_ptr rtc, UniqueId ec_id) {
  RTC::LifeCycleState state = RTC::CREATED_STATE;
  return get_state(state, rtc, ec_id) && state == wanted;
}
}  // namespace

bool is_in_inactive(const RTC::RTObject_ptr rtc, UniqueId ec_id) { return is_in(RTC::INACTIVE_STATE, rtc, ec_id); }
bool is_in_active(const RTC::RTObject_ptr rtc, UniqueId ec_id) { return is_in(RTC::ACTIVE_STATE, rtc, ec_id); }
bool is_in_error(const RTC::RTObject_ptr rtc, UniqueId ec_id) { return is_in(RTC::ERROR_STATE, rtc, ec_id); }

CORBA::Double get_default_rate(const RTC::RTObject_ptr rtc) { return get_current_rate(rtc, 0); }
ReturnCode_t set_default_rate(const RTC::RTObject_ptr rtc, CORBA::Double rate) { return set_current_rate(rtc, 0, rate); }

CORBA::Double get_current_rate(const RTC::RTObject_ptr rtc, UniqueId ec_id) {
  RTC::ExecutionContext_var ec = get_actual_ec(rtc, ec_id);
  return CORBA::is_nil(ec) ? -1.0 : guarded(-1.0, [&] { return static_cast<double>(ec->get_rate()); });
}

ReturnCode_t set_current_rate(const RTC::RTObject_ptr rtc, UniqueId ec_id, CORBA::Double rate) {
  RTC::ExecutionContext_var ec = get_actual_ec(rtc, ec_id);
  return CORBA::is_nil(ec) ? BAD_PARAMETER : guarded(RTC_ERROR, [&] { return ec->set_rate(rate); });
}

ReturnCode_t add_rtc_to_default_ec(const RTC::RTObject_ptr local_rtc, const RTC::RTObject_ptr other_rtc) {
  RTC::ExecutionContext_var ec = get_actual_ec(local_rtc, 0);
  if (CORBA::is_nil(ec) || CORBA::is_nil(other_rtc)) return BAD_PARAMETER;
  return guarded(RTC_ERROR, [&] { return ec->add_component(other_rtc); });
}

ReturnCode_t remove_rtc_to_default_ec(const RTC::RTObject_ptr local_rtc, const RTC::RTObject_ptr other_rtc) {
  RTC::ExecutionContext_var ec = get_actual_ec(local_rtc, 0);
  if (CORBA::is_nil(ec) || CORBA::is_nil(other_rtc)) return BAD_PARAMETER;
  return guarded(RTC_ERROR, [&] { return ec->remove_component(other_rtc); });
}

RTC::RTCList get_participants_rtc(const RTC::RTObject_ptr rtc) {
  return guarded(RTC::RTCList(), [&] {
    RTC::ExecutionContextService_var ec = service_of(rtc, 0);
    if (CORBA::is_nil(ec)) return RTC::RTCList();
    RTC::ExecutionContextProfile_var profile = ec->get_profile();
    return profile->participants;
  });
}

// --- ports

coil::vstring get_port_names(const RTC::RTObject_ptr rtc) { return port_names(rtc, ""); }
coil::vstring get_inport_names(const RTC::RTObject_ptr rtc) { return port_names(rtc, "DataInPort"); }
coil::vstring get_outport_names(const RTC::RTObject_ptr rtc) { return port_names(rtc, "DataOutPort"); }
coil::vstring get_svcport_names(const RTC::RTObject_ptr rtc) { return port_names(rtc, "CorbaPort"); }

RTC::PortService_ptr get_port_by_name(const RTC::RTObject_ptr rtc, const std::string& port_name) {
  if (CORBA::is_nil(rtc)) return RTC::PortService::_nil();
  return guarded(RTC::PortService::_nil(), [&] {
    RTC::ComponentProfile_var component = rtc->get_component_profile();
    const std::string full = std::string(component->instance_name) + "." + port_name;
    RTC::PortServiceList_var ports = rtc->get_ports();
    for (CORBA::ULong i = 0; i < ports->length(); ++i) {
      const auto name = name_of(ports[i]);
      if (name == port_name || name == full) return RTC::PortService::_duplicate(ports[i]);
    }
    return RTC::PortService::_nil();
  });
}

RTC::PortService_ptr get_port_by_url(const std::string& name) {
  const auto slash = name.rfind('/');
  const auto dot = name.find('.', slash == std::string::npos ? 0 : slash);
  auto* manager = RTC::Manager::instance_if_any();
  if (dot == std::string::npos || manager == nullptr || manager->getNaming() == nullptr) return RTC::PortService::_nil();
  const auto found = manager->getNaming()->string_to_component(name.substr(0, dot));
  return found.length() > 0 ? get_port_by_name(found[0], name.substr(dot + 1)) : RTC::PortService::_nil();
}

coil::vstring get_connector_names(const RTC::PortService_ptr port) {
  return connectors_of(port, [](const RTC::ConnectorProfile& profile) { return profile.name.in(); });
}
coil::vstring get_connector_ids(const RTC::PortService_ptr port) {
  return connectors_of(port, [](const RTC::ConnectorProfile& profile) { return profile.connector_id.in(); });
}
coil::vstring get_connector_names(const RTC::RTObject_ptr rtc, const std::string& port_name) {
  RTC::PortService_var port = get_port_by_name(rtc, port_name);
  return get_connector_names(port.in());
}
coil::vstring get_connector_ids(const RTC::RTObject_ptr rtc, const std::string& port_name) {
  RTC::PortService_var port = get_port_by_name(rtc, port_name);
  return get_connector_ids(port.in());
}
coil::vstring get_connector_names_by_portref(const RTC::PortService_ptr port) { return get_connector_names(port); }
coil::vstring get_connector_ids_by_portref(const RTC::PortService_ptr port) { return get_connector_ids(port); }

// --- connections

RTC::ConnectorProfile_var create_connector(const std::string& name, const coil::Properties& given, const RTC::PortServiceList& ports) {
  coil::Properties properties;
  for (const auto& key : given.propertyNames()) {
    const bool is_full = key.starts_with("dataport.") || key.starts_with("port.");
    properties.setProperty(is_full ? key : "dataport." + key, given.getProperty(key));
  }
  if (properties.getProperty("dataport.dataflow_type").empty()) properties.setProperty("dataport.dataflow_type", "push");
  if (properties.getProperty("dataport.interface_type").empty()) properties.setProperty("dataport.interface_type", "corba_cdr");
  RTC::ConnectorProfile_var profile = new RTC::ConnectorProfile;
  profile->connector_id = "";
  profile->name = name.c_str();
  profile->ports = ports;
  NVUtil::copyFromProperties(profile->properties, properties);
  return profile;
}

RTC::ConnectorProfile_var create_connector(const std::string& name, const coil::Properties& properties, const RTC::PortService_ptr port0,
                                           const RTC::PortService_ptr port1) {
  RTC::PortServiceList ports;
  ports.length(CORBA::is_nil(port1) ? 1 : 2);
  ports[0] = RTC::PortService::_duplicate(port0);
  if (!CORBA::is_nil(port1)) ports[1] = RTC::PortService::_duplicate(port1);
  return create_connector(name, properties, ports);
}

bool already_connected(const RTC::PortService_ptr port0, const RTC::PortService_ptr port1) {
  if (CORBA::is_nil(port0) || CORBA::is_nil(port1)) return false;
  return guarded(false, [&] {
    RTC::ConnectorProfileList_var profiles = port0->get_connector_profiles();
    for (CORBA::ULong i = 0; i < profiles->length(); ++i) {
      const auto& ports = profiles[i].ports;
      for (CORBA::ULong j = 0; j < ports.length(); ++j) {
        if (!CORBA::is_nil(ports[j]) && ports[j]->_is_equivalent(port1)) return true;
      }
    }
    return false;
  });
}

ReturnCode_t connect(const std::string& name, const coil::Properties& properties, const RTC::PortServiceList& ports) {
  if (ports.length() == 0 || CORBA::is_nil(ports[0])) return BAD_PARAMETER;
  return guarded(RTC_ERROR, [&] {
    RTC::ConnectorProfile_var profile = create_connector(name, properties, ports);
    return ports[0]->connect(profile.inout());
  });
}

ReturnCode_t connect(const std::string& name, const coil::Properties& properties, const RTC::PortService_ptr port0,
                     const RTC::PortService_ptr port1) {
  if (CORBA::is_nil(port0) || CORBA::is_nil(port1) || port0->_is_equivalent(port1)) return BAD_PARAMETER;
  return guarded(RTC_ERROR, [&] {
    RTC::ConnectorProfile_var profile = create_connector(name, properties, port0, port1);
    return port0->connect(profile.inout());
  });
}

ReturnCode_t connect_multi(const std::string& name, const coil::Properties& properties, const RTC::PortService_ptr port,
                           const RTC::PortServiceList& targets) {
  if (CORBA::is_nil(port)) return BAD_PARAMETER;
  ReturnCode_t result = RTC_OK;
  for (CORBA::ULong i = 0; i < targets.length(); ++i) {
    if (CORBA::is_nil(targets[i]) || targets[i]->_is_equivalent(port) || already_connected(port, targets[i])) continue;
    if (connect(name + std::to_string(i), properties, port, targets[i]) != RTC_OK) result = BAD_PARAMETER;
  }
  return result;
}

ReturnCode_t connect_by_name(const std::string& name, const coil::Properties& properties, const RTC::RTObject_ptr rtc0,
                             const std::string& port_name0, const RTC::RTObject_ptr rtc1, const std::string& port_name1) {
  RTC::PortService_var port0 = get_port_by_name(rtc0, port_name0);
  RTC::PortService_var port1 = get_port_by_name(rtc1, port_name1);
  return connect(name, properties, port0, port1);
}

ReturnCode_t disconnect(const RTC::ConnectorProfile& profile) {
  for (CORBA::ULong i = 0; i < profile.ports.length(); ++i) {
    if (!CORBA::is_nil(profile.ports[i])) return disconnect_connector_id(profile.ports[i], profile.connector_id.in());
  }
  return BAD_PARAMETER;
}

ReturnCode_t disconnect_connector_id(const RTC::PortService_ptr port, const std::string& connector_id) {
  return CORBA::is_nil(port) ? BAD_PARAMETER : guarded(RTC_ERROR, [&] { return port->disconnect(connector_id.c_str()); });
}

ReturnCode_t disconnect_connector_name(const RTC::PortService_ptr port, const std::string& connector_name) {
  if (CORBA::is_nil(port)) return BAD_PARAMETER;
  return guarded(RTC_ERROR, [&] {
    RTC::ConnectorProfileList_var profiles = port->get_connector_profiles();
    for (CORBA::ULong i = 0; i < profiles->length(); ++i) {
      if (connector_name == profiles[i].name.in()) return port->disconnect(profiles[i].connector_id);
    }
    return BAD_PARAMETER;
  });
}

ReturnCode_t disconnect_all(const RTC::PortService_ptr port) {
  return CORBA::is_nil(port) ? BAD_PARAMETER : guarded(RTC_ERROR, [&] { return port->disconnect_all(); });
}

ReturnCode_t disconnect_connector_name(const std::string& port_url, const std::string& connector_name) {
  RTC::PortService_var port = get_port_by_url(port_url);
  return disconnect_connector_name(port.in(), connector_name);
}
ReturnCode_t disconnect_connector_id(const std::string& port_url, const std::string& connector_id) {
  RTC::PortService_var port = get_port_by_url(port_url);
  return disconnect_connector_id(port.in(), connector_id);
}
ReturnCode_t disconnect_all(const std::string& port_url) {
  RTC::PortService_var port = get_port_by_url(port_url);
  return disconnect_all(port.in());
}

ReturnCode_t disconnect_by_portref_connector_name(const RTC::PortService_ptr port, const std::string& connector_name) {
  return disconnect_connector_name(port, connector_name);
}
ReturnCode_t disconnect_by_portref_connector_id(const RTC::PortService_ptr port, const std::string& connector_id) {
  return disconnect_connector_id(port, connector_id);
}
ReturnCode_t disconnect_all_by_ref(const RTC::PortService_ptr port) { return disconnect_all(port); }
ReturnCode_t disconnect_by_portname_connector_name(const std::string& port_name, const std::string& connector_name) {
  return disconnect_connector_name(port_name, connector_name);
}
ReturnCode_t disconnect_by_portname_connector_id(const std::string& port_name, const std::string& connector_id) {
  return disconnect_connector_id(port_name, connector_id);
}
ReturnCode_t disconnect_all_by_name(const std::string& port_name) { return disconnect_all(port_name); }

// --- configuration

namespace {

// A component may have none.
SDOPackage::Configuration_ptr configuration_of(const RTC::RTObject_ptr rtc) {
  SDOPackage::Configuration_var configuration = rtc->get_configuration();
  if (CORBA::is_nil(configuration)) throw CORBA::NO_IMPLEMENT();
  return configuration._retn();
}

}  // namespace

coil::Properties get_configuration(const RTC::RTObject_ptr rtc, const std::string& set_name) {
  if (CORBA::is_nil(rtc)) return {};
  return guarded(coil::Properties(), [&] {
    SDOPackage::Configuration_var configuration = configuration_of(rtc);
    SDOPackage::ConfigurationSet_var set = configuration->get_configuration_set(set_name.c_str());
    coil::Properties properties;
    NVUtil::copyToProperties(properties, set->configuration_data);
    return properties;
  });
}

std::string get_active_configuration_name(const RTC::RTObject_ptr rtc) {
  if (CORBA::is_nil(rtc)) return {};
  return guarded(std::string(), [&] {
    SDOPackage::Configuration_var configuration = configuration_of(rtc);
    SDOPackage::ConfigurationSet_var set = configuration->get_active_configuration_set();
    return std::string(set->id);
  });
}

coil::Properties get_active_configuration(const RTC::RTObject_ptr rtc) {
  if (CORBA::is_nil(rtc)) return {};
  return guarded(coil::Properties(), [&] {
    SDOPackage::Configuration_var configuration = configuration_of(rtc);
    SDOPackage::ConfigurationSet_var set = configuration->get_active_configuration_set();
    coil::Properties properties;
    NVUtil::copyToProperties(properties, set->configuration_data);
    return properties;
  });
}

std::string get_parameter_by_key(const RTC::RTObject_ptr rtc, const std::string& set_name, const std::string& key) {
  return static_cast<const coil::Properties&>(get_configuration(rtc, set_name)).getProperty(key);
}

bool set_configuration(const RTC::RTObject_ptr rtc, const std::string& set_name, const std::string& key, const std::string& value) {
  if (CORBA::is_nil(rtc)) return false;
  const auto active = get_active_configuration_name(rtc);
  return guarded(false, [&] {
    SDOPackage::Configuration_var configuration = configuration_of(rtc);
    SDOPackage::ConfigurationSet_var set = configuration->get_configuration_set(set_name.c_str());
    NVUtil::setStringValue(set->configuration_data, key.c_str(), value.c_str());
    if (!configuration->set_configuration_set_values(set)) return false;
    return active != set_name || configuration->activate_configuration_set(set_name.c_str());
  });
}

bool set_active_configuration(const RTC::RTObject_ptr rtc, const std::string& key, const std::string& value) {
  const auto active = get_active_configuration_name(rtc);
  return !active.empty() && set_configuration(rtc, active, key, value);
}

}  // namespace CORBA_RTCUtil
