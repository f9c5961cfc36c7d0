// The classic base of all ports: the PortService object with names, properties, callbacks and listeners. Any thread, except that names,
// properties and callbacks are set before the port is used.
#pragma once

#include <coil/Properties.h>

#include <functional>
#include <string>
#include <vector>

#include "corba/port_servant.h"
#include "rtm/PortCallback.h"
#include "rtm/PortConnectListener.h"
#include "rtm/SystemLogger.h"
#include "rtm/idl/RTCSkel.h"

namespace RTC {

class ConnectionCallback;

class PortBase : public corba::PortServant {
 public:
  explicit PortBase(const char* name = "");
  ~PortBase() override;

  void setName(const char* name);
  const char* getName() const { return name_.c_str(); }
  // A copy, without asking anyone.
  RTC::PortProfile getPortProfile() const { return profile(); }
  RTC::PortProfile getProfile() const { return profile(); }
  void setPortRef(PortService_ptr port_ref);
  // Borrowed; activates the port at the first call.
  PortService_ptr getPortRef() { return reference(); }
  void setOwner(RTObject_ptr owner);

  // Takes over the properties of the port (the merged port.* nodes) and shows them in the profile.
  virtual void init(coil::Properties& properties);
  coil::Properties& properties() { return m_properties; }
  // Adds a value to the comma list of that key in the profile.
  bool appendProperty(const char* key, const char* value);
  template <class Value>
  void addProperty(const char* key, Value value) {
    set_profile_property(key, std::string(value));
  }

  // Called when the component becomes active and when it is not any more.
  virtual void activateInterfaces() = 0;
  virtual void deactivateInterfaces() = 0;

  // The callbacks are not owned; nullptr removes one.
  void setOnPublishInterfaces(ConnectionCallback* callback) { m_onPublishInterfaces = callback; }
  void setOnSubscribeInterfaces(ConnectionCallback* callback) { m_onSubscribeInterfaces = callback; }
  void setOnConnected(ConnectionCallback* callback) { m_onConnected = callback; }
  void setOnUnsubscribeInterfaces(ConnectionCallback* callback) { m_onUnsubscribeInterfaces = callback; }
  void setOnDisconnected(ConnectionCallback* callback) { m_onDisconnected = callback; }
  void setOnConnectionLost(ConnectionCallback* callback) { m_onConnectionLost = callback; }
  // Not owned; must outlive the port or be replaced by nullptr.
  void setPortConnectListenerHolder(PortConnectListeners* listeners) { m_portconnListeners = listeners; }

 protected:
  virtual ReturnCode_t publishInterfaces(ConnectorProfile& profile) = 0;
  virtual ReturnCode_t subscribeInterfaces(const ConnectorProfile& profile) = 0;
  virtual void unsubscribeInterfaces(const ConnectorProfile& profile) = 0;

  void setConnectionLimit(int limit) { set_connection_limit(limit); }
  bool appendInterface(const char* instance_name, const char* type_name, PortInterfacePolarity polarity);
  bool deleteInterface(const char* name, PortInterfacePolarity polarity);

  Logger rtclog;
  coil::Properties m_properties;
  PortService_var m_objref;  // from the first getPortRef on, at the latest since the component has the port
  ConnectionCallback* m_onPublishInterfaces = nullptr;
  ConnectionCallback* m_onSubscribeInterfaces = nullptr;
  ConnectionCallback* m_onConnected = nullptr;
  ConnectionCallback* m_onUnsubscribeInterfaces = nullptr;
  ConnectionCallback* m_onDisconnected = nullptr;
  ConnectionCallback* m_onConnectionLost = nullptr;
  PortConnectListeners* m_portconnListeners = nullptr;

 private:
  ReturnCode_t publish(ConnectorProfile& profile) final;
  ReturnCode_t subscribe(const ConnectorProfile& profile) final;
  void unsubscribe(const ConnectorProfile& profile, bool is_lost) final;
  void activated(PortService_ptr port_ref) final { m_objref = RTC::PortService::_duplicate(port_ref); }
  void on_step(Step step, ConnectorProfile& profile, ReturnCode_t code) final;

  std::string name_;
};

}  // namespace RTC
