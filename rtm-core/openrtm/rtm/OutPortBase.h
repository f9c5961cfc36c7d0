// All of an OutPort that does not depend on its type. Any thread; samples written by one thread keep their order.
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
class OutEngine;
}

namespace RTC {

class OutPortBase : public PortBase, public DataPortStatus {
 public:
  using ConnectorList = std::vector<OutPortConnector*>;

  OutPortBase(const char* name, const corba::TypeOps& type);
  ~OutPortBase() override;

  void init(coil::Properties& properties) override;
  void activateInterfaces() override {}
  void deactivateInterfaces() override {}

  // Writes the bound variable; false if there is no connection or one failed; the statuses tell which.
  virtual bool write() = 0;
  virtual const char* name() { return short_name_.c_str(); }

  // Of the last write, per connection in the order of connectors().
  DataPortStatus getStatus(int index) const;
  DataPortStatusList getStatusList() const;

  // The pointers are good until the connection is taken apart.
  ConnectorList connectors() const;
  ConnectorInfoList getConnectorProfiles() const;
  coil::vstring getConnectorIds() const;
  coil::vstring getConnectorNames() const;
  OutPortConnector* getConnectorById(const char* id) const;
  OutPortConnector* getConnectorByName(const char* name) const;
  bool getConnectorProfileById(const char* id, ConnectorInfo& info) const;
  bool getConnectorProfileByName(const char* name, ConnectorInfo& info) const;

  // With autoclean the port deletes the listener.
  void addConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener, bool autoclean = true);
  void removeConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener);
  void addConnectorListener(ConnectorListenerType type, ConnectorListener* listener, bool autoclean = true);
  void removeConnectorListener(ConnectorListenerType type, ConnectorListener* listener);
  ConnectorListeners& getListeners() { return *listeners_; }

 protected:
  // Returns when no other thread is in the port any more. The destructor of the last class in line calls it first.
  void retire();
  bool writeValue(const void* value);

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
  std::unique_ptr<corba::OutEngine> engine_;
};

}  // namespace RTC
