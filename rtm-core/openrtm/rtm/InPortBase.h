// All of an InPort that does not depend on its type. connect, disconnect, reading and receiving: any thread; one reader at a time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "corba/type_ops.h"
#include "rtm/ConnectorBase.h"
#include "rtm/ConnectorListener.h"
#include "rtm/DataPortStatus.h"
#include "rtm/PortBase.h"

namespace corba {
class InEngine;
}

namespace RTC {

class InPortBase : public PortBase, public DataPortStatus {
 public:
  using ConnectorList = std::vector<InPortConnector*>;

  InPortBase(const char* name, const corba::TypeOps& type);
  ~InPortBase() override;

  void init(coil::Properties& properties) override;
  void activateInterfaces() override {}
  void deactivateInterfaces() override {}

  // False if there was nothing to read; the statuses tell why.
  virtual bool read(std::string name = "") = 0;
  virtual const char* name() { return short_name_.c_str(); }

  // Something has come that was not read yet, on any connection, or on the one of that name. A pull connection asks its peer.
  bool isNew();
  bool isNew(const std::string& connector_name);
  // Also says on which connections.
  bool isNew(coil::vstring& connector_names);
  bool isEmpty() { return !isNew(); }
  bool isEmpty(const std::string& connector_name) { return !isNew(connector_name); }

  // Of the last read, per connection in the order of connectors().
  DataPortStatus getStatus(int index) const;
  DataPortStatusList getStatusList() const;

  // The pointers are good until the connection is taken apart.
  ConnectorList connectors() const;
  ConnectorInfoList getConnectorProfiles() const;
  coil::vstring getConnectorIds() const;
  coil::vstring getConnectorNames() const;
  InPortConnector* getConnectorById(const char* id) const;
  InPortConnector* getConnectorByName(const char* name) const;
  bool getConnectorProfileById(const char* id, ConnectorInfo& info) const;
  bool getConnectorProfileByName(const char* name, ConnectorInfo& info) const;

  // With autoclean the port deletes the listener.
  void addConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener, bool autoclean = true);
  void removeConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener);
  void addConnectorListener(ConnectorListenerType type, ConnectorListener* listener, bool autoclean = true);
  void removeConnectorListener(ConnectorListenerType type, ConnectorListener* listener);
  ConnectorListeners& getListeners() { return *listeners_; }

  // The connections' side of the port, for ports of the same process.
  corba::InEngine& engine() { return *engine_; }

 protected:
  // Returns when no other thread is in the port any more. The destructor of the last class in line calls it first.
  void retire();
  // Decodes the oldest unread sample (of that connection) into `value`, or the last one again.
  bool readValue(const std::string& connector_name, void* value);

  void complete_profile(ConnectorProfile& profile) override;
  ReturnCode_t prepare(ConnectorProfile& profile) override;
  bool allows_duplicate(const ConnectorProfile& profile) override;
  ReturnCode_t publishInterfaces(ConnectorProfile& profile) override;
  ReturnCode_t subscribeInterfaces(const ConnectorProfile& profile) override;
  void unsubscribeInterfaces(const ConnectorProfile& profile) override;

 private:
  // Makes the connection in publishInterfaces if this side provides the object, else in subscribeInterfaces.
  ReturnCode_t open(ConnectorProfile& profile, bool provides);

  std::string short_name_;
  std::shared_ptr<ConnectorListeners> listeners_;
  std::unique_ptr<corba::InEngine> engine_;
};

}  // namespace RTC
