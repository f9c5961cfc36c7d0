#include "rtm/PortBase.h"

#include "base/text.h"
#include "corba/nv_list.h"

namespace RTC {

PortBase::PortBase(const char* name) : PortServant(name), rtclog(name), name_(name) {}

PortBase::~PortBase() { shut(); }

void PortBase::setName(const char* name) {
  name_ = name;
  rtclog.setName(name);
  set_port_name(name_);
}

void PortBase::setPortRef(PortService_ptr port_ref) {
  set_reference(port_ref);
  m_objref = RTC::PortService::_duplicate(port_ref);
}

void PortBase::setOwner(RTObject_ptr owner) { set_owner(owner); }

void PortBase::init(coil::Properties& properties) {
  m_properties << properties;
  for (const auto& name : m_properties.propertyNames()) {
    const std::string& value = m_properties.getProperty(name);
    if (!value.empty()) set_profile_property(name, value);
  }
  for (const char* key : {"connection_limit", "dataport.connection_limit"}) {
    if (const auto limit = base::parse_integer(m_properties.getProperty(key))) setConnectionLimit(static_cast<int>(*limit));
  }
}

bool PortBase::appendProperty(const char* key, const char* value) {
  const std::string present = profile_property(key);
  const std::string added(base::trim(value));
  auto parts = base::split_list(present);
  for (const auto& part : parts) {
    if (part == added) return true;
  }
  parts.push_back(added);
  set_profile_property(key, base::join(parts, ","));
  return true;
}

bool PortBase::appendInterface(const char* instance_name, const char* type_name, PortInterfacePolarity polarity) {
  return add_interface(instance_name, type_name, polarity);
}

bool PortBase::deleteInterface(const char* name, PortInterfacePolarity polarity) { return remove_interface(name, polarity); }

ReturnCode_t PortBase::publish(ConnectorProfile& profile) { return publishInterfaces(profile); }

ReturnCode_t PortBase::subscribe(const ConnectorProfile& profile) {
  if (m_onSubscribeInterfaces) {
    ConnectorProfile copy = profile;
    (*m_onSubscribeInterfaces)(copy);
  }
  return subscribeInterfaces(profile);
}

void PortBase::unsubscribe(const ConnectorProfile& profile, bool is_lost) {
  if (is_lost && m_onConnectionLost) {
    ConnectorProfile copy = profile;
    (*m_onConnectionLost)(copy);
  }
  unsubscribeInterfaces(profile);
}

void PortBase::on_step(Step step, ConnectorProfile& profile, ReturnCode_t code) {
  const auto call = [&](ConnectionCallback* callback) {
    if (callback) (*callback)(profile);
  };
  const auto tell = [&](PortConnectListenerType type) {
    if (m_portconnListeners) m_portconnListeners->portconnect_[type].notify(getName(), profile);
  };
  const auto tell_result = [&](PortConnectRetListenerType type) {
    if (m_portconnListeners) m_portconnListeners->portconnret_[type].notify(getName(), profile, code);
  };
  switch (step) {
    case Step::notify_connect:
      tell(ON_NOTIFY_CONNECT);
      break;
    case Step::published:
      call(m_onPublishInterfaces);
      tell_result(ON_PUBLISH_INTERFACES);
      break;
    case Step::next_connected:
      tell_result(ON_CONNECT_NEXTPORT);
      break;
    case Step::subscribed:
      tell_result(ON_SUBSCRIBE_INTERFACES);
      break;
    case Step::connected:
      call(m_onConnected);
      tell_result(ON_CONNECTED);
      break;
    case Step::notify_disconnect:
      tell(ON_NOTIFY_DISCONNECT);
      break;
    case Step::next_disconnected:
      tell_result(ON_DISCONNECT_NEXT);
      break;
    case Step::unsubscribed:
      call(m_onUnsubscribeInterfaces);
      tell(ON_UNSUBSCRIBE_INTERFACES);
      break;
    case Step::disconnected:
      call(m_onDisconnected);
      tell_result(ON_DISCONNECTED);
      break;
  }
}

}  // namespace RTC
