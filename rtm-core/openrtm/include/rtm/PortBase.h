// The classic base of all ports: the PortService object with names, properties, callbacks and listeners. Any thread, except that names,
// properties and callbacks are set before the port is used.
#pragma once

#include <coil/Guard.h>
#include <coil/Mutex.h>
#include <coil/Properties.h>

#include <memory>
#include <string>
#include <vector>

#include "rtm/CORBA_SeqUtil.h"
#include "rtm/NVUtil.h"
#include "rtm/PortCallback.h"
#include "rtm/PortConnectListener.h"
#include "rtm/RTC.h"
#include "rtm/SystemLogger.h"
#include "rtm/idl/RTCSkel.h"

namespace RTC {

namespace detail {
struct PortTerms;  // of a connection
}

class ConnectionCallback;

class PortBase {
 public:
  explicit PortBase(const char* name = "");
  virtual ~PortBase();
  PortBase(const PortBase&) = delete;
  PortBase& operator=(const PortBase&) = delete;

  // The operations of the PortService object.
  virtual PortProfile* get_port_profile();
  virtual ConnectorProfileList* get_connector_profiles();
  // An empty profile if there is no such connection.
  virtual ConnectorProfile* get_connector_profile(const char* connector_id);
  virtual ReturnCode_t connect(ConnectorProfile& connector_profile);
  virtual ReturnCode_t disconnect(const char* connector_id);
  virtual ReturnCode_t disconnect_all();
  virtual ReturnCode_t notify_connect(ConnectorProfile& connector_profile);
  virtual ReturnCode_t notify_disconnect(const char* connector_id);

  void setName(const char* name);
  const char* getName() const { return name_.c_str(); }
  // A copy, without asking anyone.
  PortProfile getPortProfile() const;
  PortProfile getProfile() const { return getPortProfile(); }
  void setPortRef(PortService_ptr port_ref);
  // Borrowed; activates the port at the first call.
  PortService_ptr getPortRef();
  // The same, for the caller to release.
  PortService_ptr _this() { return PortService::_duplicate(getPortRef()); }
  void setOwner(RTObject_ptr owner);

  // Takes over the properties of the port (the merged port.* nodes) and shows them in the profile.
  virtual void init(coil::Properties& properties);
  coil::Properties& properties() { return m_properties; }
  // Adds a value to the comma list of that key in the profile.
  bool appendProperty(const char* key, const char* value);
  void addProperty(const char* key, const char* value);
  void addProperty(const char* key, const std::string& value) { addProperty(key, value.c_str()); }

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
  void setPortConnectListenerHolder(PortConnectListeners* listeners);

  // No call from outside is accepted after this; connections stay.
  void deactivate();

 protected:
  virtual ReturnCode_t publishInterfaces(ConnectorProfile& profile) = 0;
  virtual ReturnCode_t subscribeInterfaces(const ConnectorProfile& profile) = 0;
  virtual void unsubscribeInterfaces(const ConnectorProfile& profile) = 0;

  void setConnectionLimit(int limit);
  bool appendInterface(const char* instance_name, const char* type_name, PortInterfacePolarity polarity);
  bool deleteInterface(const char* name, PortInterfacePolarity polarity);

  // For the ports of this library, in the order in which a connection calls them (corba/ports/port_servant.h). The terms are what
  // read_terms has found in the profile when the port heard of the connection.
  virtual void complete_profile(ConnectorProfile&) {}
  virtual std::shared_ptr<detail::PortTerms> read_terms(const ConnectorProfile& profile);
  virtual ReturnCode_t prepare(ConnectorProfile&, const detail::PortTerms&) { return RTC_OK; }
  virtual ReturnCode_t publish(ConnectorProfile& profile, const detail::PortTerms&) { return publishInterfaces(profile); }
  virtual ReturnCode_t subscribe(const ConnectorProfile& profile, const detail::PortTerms&) { return subscribeInterfaces(profile); }
  // Adds to the PortProfile what may change while the port is there.
  virtual void complete(PortProfile&) const {}
  // No call from outside is running or accepted when it returns; connections stay. Classes that end the line of derivation call it first in
  // their destructors.
  void shut();
  // Removes the connection on this side without calling anyone, because the other end is gone. False if it is not there (any more).
  bool drop_connection(const char* connector_id);

  Logger rtclog;
  coil::Properties m_properties;
  PortService_var m_objref;  // from the first getPortRef on, at the latest since the component has the port
  ConnectionCallback* m_onPublishInterfaces = nullptr;
  ConnectionCallback* m_onSubscribeInterfaces = nullptr;
  ConnectionCallback* m_onConnected = nullptr;
  ConnectionCallback* m_onUnsubscribeInterfaces = nullptr;
  ConnectionCallback* m_onDisconnected = nullptr;
  ConnectionCallback* m_onConnectionLost = nullptr;
  PortConnectListeners* m_portconnListeners = nullptr;  // a connection may be made or ended by others while it changes

 private:
  class Servant;

  std::string name_;
  std::unique_ptr<Servant> servant_;
};

}  // namespace RTC
