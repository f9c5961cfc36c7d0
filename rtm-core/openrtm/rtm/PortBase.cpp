#include "rtm/PortBase.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>

#include "base/text.h"
#include "corba/orb/nv_list.h"
#include "corba/ports/port_servant.h"
#include "openrtm/opaque_types.h"

namespace RTC {

// The object that peers call. What it asks of its port is behind PortBase's virtual functions.
class PortBase::Servant final : public corba::PortServant {
 public:
  Servant(PortBase& port, const char* name) : PortServant(name), port_(port) {}

  using PortServant::add_interface;
  using PortServant::profile;
  using PortServant::profile_property;
  using PortServant::remove_interface;
  using PortServant::set_connection_limit;
  using PortServant::set_owner;
  using PortServant::set_port_name;
  using PortServant::set_profile_property;
  using PortServant::set_reference;

 private:
  using Terms = corba::ConnectionTerms;

  // All terms are of read_terms.
  static const detail::PortTerms& own(const Terms& terms) { return static_cast<const detail::PortTerms&>(terms); }

  void complete_profile(ConnectorProfile& profile) override { port_.complete_profile(profile); }
  std::shared_ptr<Terms> read_terms(const ConnectorProfile& profile) override { return port_.read_terms(profile); }
  ReturnCode_t prepare(ConnectorProfile& profile, const Terms& terms) override { return port_.prepare(profile, own(terms)); }
  ReturnCode_t publish(ConnectorProfile& profile, const Terms& terms) override { return port_.publish(profile, own(terms)); }
  ReturnCode_t subscribe(const ConnectorProfile& profile, const Terms& terms) override {
    call(port_.m_onSubscribeInterfaces, profile);
    return port_.subscribe(profile, own(terms));
  }
  void unsubscribe(const ConnectorProfile& profile, bool is_lost) override {
    if (is_lost) call(port_.m_onConnectionLost, profile);
    port_.unsubscribeInterfaces(profile);
  }
  void complete(PortProfile& profile) const override { port_.complete(profile); }
  void activated(PortService_ptr port_ref) override { port_.m_objref = RTC::PortService::_duplicate(port_ref); }
  void on_step(Step step, ConnectorProfile& profile, ReturnCode_t code) override;

  static void call(ConnectionCallback* callback, const ConnectorProfile& profile) {
    if (!callback) return;
    ConnectorProfile copy = profile;
    (*callback)(copy);
  }

  PortBase& port_;
};

PortBase::PortBase(const char* name) : rtclog(name), name_(name), servant_(std::make_unique<Servant>(*this, name)) {}

PortBase::~PortBase() { shut(); }

void PortBase::setPortConnectListenerHolder(PortConnectListeners* listeners) {
  std::atomic_ref(m_portconnListeners).store(listeners, std::memory_order_release);  // pairs with the acquire in on_step
}

void PortBase::shut() { servant_->shut(); }
void PortBase::deactivate() { servant_->deactivate(); }
bool PortBase::drop_connection(const char* connector_id) { return servant_->drop_connection(connector_id); }

PortProfile* PortBase::get_port_profile() { return servant_->get_port_profile(); }
ConnectorProfileList* PortBase::get_connector_profiles() { return servant_->get_connector_profiles(); }
ConnectorProfile* PortBase::get_connector_profile(const char* connector_id) { return servant_->get_connector_profile(connector_id); }
ReturnCode_t PortBase::connect(ConnectorProfile& connector_profile) { return servant_->connect(connector_profile); }
ReturnCode_t PortBase::disconnect(const char* connector_id) { return servant_->disconnect(connector_id); }
ReturnCode_t PortBase::disconnect_all() { return servant_->disconnect_all(); }
ReturnCode_t PortBase::notify_connect(ConnectorProfile& connector_profile) { return servant_->notify_connect(connector_profile); }
ReturnCode_t PortBase::notify_disconnect(const char* connector_id) { return servant_->notify_disconnect(connector_id); }

PortProfile PortBase::getPortProfile() const { return servant_->profile(); }
PortService_ptr PortBase::getPortRef() { return servant_->reference(); }

std::shared_ptr<detail::PortTerms> PortBase::read_terms(const ConnectorProfile&) { return std::make_shared<detail::PortTerms>(); }

void PortBase::setName(const char* name) {
  name_ = name;
  rtclog.setName(name);
  servant_->set_port_name(name_);
}

void PortBase::setPortRef(PortService_ptr port_ref) {
  servant_->set_reference(port_ref);
  m_objref = RTC::PortService::_duplicate(port_ref);
}

void PortBase::setOwner(RTObject_ptr owner) { servant_->set_owner(owner); }

void PortBase::setConnectionLimit(int limit) { servant_->set_connection_limit(limit); }

void PortBase::addProperty(const char* key, const char* value) { servant_->set_profile_property(key, value); }

void PortBase::init(coil::Properties& properties) {
  m_properties << properties;
  for (const auto& name : m_properties.propertyNames()) {
    const std::string& value = m_properties.getProperty(name);
    if (!value.empty()) addProperty(name.c_str(), value);
  }
  for (const char* key : {"connection_limit", "dataport.connection_limit"}) {
    if (const auto limit = base::parse_integer(m_properties.getProperty(key)))
      setConnectionLimit(static_cast<int>(std::clamp<std::int64_t>(*limit, -1, std::numeric_limits<int>::max())));
  }
}

bool PortBase::appendProperty(const char* key, const char* value) {
  const std::string present = servant_->profile_property(key);
  const std::string added(base::trim(value));
  auto parts = base::split_list(present);
  for (const auto& part : parts) {
    if (part == added) return true;
  }
  parts.push_back(added);
  servant_->set_profile_property(key, base::join(parts, ","));
  return true;
}

bool PortBase::appendInterface(const char* instance_name, const char* type_name, PortInterfacePolarity polarity) {
  return servant_->add_interface(instance_name, type_name, polarity);
}

bool PortBase::deleteInterface(const char* name, PortInterfacePolarity polarity) { return servant_->remove_interface(name, polarity); }

void PortBase::Servant::on_step(Step step, ConnectorProfile& profile, ReturnCode_t code) {
  const auto call = [&](ConnectionCallback* callback) {
    if (callback) (*callback)(profile);
  };
  PortConnectListeners* const listeners = std::atomic_ref(port_.m_portconnListeners).load(std::memory_order_acquire);
  const auto tell = [&](PortConnectListenerType type) {
    if (listeners) listeners->portconnect_[type].notify(port_.getName(), profile);
  };
  const auto tell_result = [&](PortConnectRetListenerType type) {
    if (listeners) listeners->portconnret_[type].notify(port_.getName(), profile, code);
  };
  switch (step) {
    case Step::notify_connect:
      tell(ON_NOTIFY_CONNECT);
      break;
    case Step::published:
      call(port_.m_onPublishInterfaces);
      tell_result(ON_PUBLISH_INTERFACES);
      break;
    case Step::next_connected:
      tell_result(ON_CONNECT_NEXTPORT);
      break;
    case Step::subscribed:
      tell_result(ON_SUBSCRIBE_INTERFACES);
      break;
    case Step::connected:
      call(port_.m_onConnected);
      tell_result(ON_CONNECTED);
      break;
    case Step::notify_disconnect:
      tell(ON_NOTIFY_DISCONNECT);
      break;
    case Step::next_disconnected:
      tell_result(ON_DISCONNECT_NEXT);
      break;
    case Step::unsubscribed:
      call(port_.m_onUnsubscribeInterfaces);
      tell(ON_UNSUBSCRIBE_INTERFACES);
      break;
    case Step::disconnected:
      call(port_.m_onDisconnected);
      tell_result(ON_DISCONNECTED);
      break;
  }
}

}  // namespace RTC
