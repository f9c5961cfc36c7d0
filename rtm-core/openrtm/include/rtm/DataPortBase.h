// Common base of InPorts and OutPorts: their connections as component authors see them. Any thread.
#pragma once

#include <coil/Guard.h>
#include <coil/Mutex.h>

#include <memory>
#include <string>
#include <vector>

#include "rtm/ConnectorBase.h"
#include "rtm/ConnectorListener.h"
#include "rtm/DataPortStatus.h"
#include "rtm/PortBase.h"

namespace RTC {

namespace detail {
class DataPortCore;
class DataType;
class Serializers;

// connectors() as ports of authors know them: a member that changes with the connections. begin() and size() look again; what they found is
// there by index. For the thread that holds m_connectorsMutex.
template <class Port>
class ConnectorsView {
 public:
  explicit ConnectorsView(const Port& port) : port_(port) {}
  auto begin() { return (found_ = port_.connectors()).begin(); }
  auto end() { return found_.end(); }
  std::size_t size() { return (found_ = port_.connectors()).size(); }
  bool empty() { return size() == 0; }
  // nullptr where there is none (any more).
  auto operator[](std::size_t at) const -> typename Port::ConnectorList::value_type { return at < found_.size() ? found_[at] : nullptr; }
  auto at(std::size_t at) const { return found_.at(at); }
  operator typename Port::ConnectorList() const { return port_.connectors(); }

 private:
  const Port& port_;
  typename Port::ConnectorList found_{};
};
}  // namespace detail

// Connector: InPortConnector or OutPortConnector.
template <class Connector>
class DataPortBase : public PortBase, public DataPortStatus {
 public:
  using ConnectorList = std::vector<Connector*>;

  ~DataPortBase() override;

  void init(coil::Properties& properties) override { PortBase::init(properties); }
  void activateInterfaces() override {}
  void deactivateInterfaces() override {}

  virtual const char* name() { return short_name_.c_str(); }

  // Of the last read or write, per connection in the order of connectors().
  DataPortStatus getStatus(int index) const;
  DataPortStatusList getStatusList() const;

  // The pointers are good until the connection is taken apart.
  ConnectorList connectors() const;
  ConnectorInfoList getConnectorProfiles() const;
  coil::vstring getConnectorIds() const;
  coil::vstring getConnectorNames() const;
  Connector* getConnectorById(const char* id) const;
  Connector* getConnectorByName(const char* name) const;
  bool getConnectorProfileById(const char* id, ConnectorInfo& info) const;
  bool getConnectorProfileByName(const char* name, ConnectorInfo& info) const;

  // With autoclean the port deletes the listener.
  void addConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener, bool autoclean = true);
  void removeConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener);
  void addConnectorListener(ConnectorListenerType type, ConnectorListener* listener, bool autoclean = true);
  void removeConnectorListener(ConnectorListenerType type, ConnectorListener* listener);
  ConnectorListeners& getListeners();

 protected:
  DataPortBase(const char* name, std::unique_ptr<detail::DataPortCore> core);

  // Shows the serializers that are registered by now.
  void complete(PortProfile& profile) const override;
  void complete_profile(ConnectorProfile& profile) override;
  std::shared_ptr<detail::PortTerms> read_terms(const ConnectorProfile& profile) override;
  ReturnCode_t prepare(ConnectorProfile& profile, const detail::PortTerms& terms) override;
  ReturnCode_t publish(ConnectorProfile& profile, const detail::PortTerms& terms) override;
  ReturnCode_t subscribe(const ConnectorProfile& profile, const detail::PortTerms& terms) override;
  ReturnCode_t publishInterfaces(ConnectorProfile& profile) override;
  ReturnCode_t subscribeInterfaces(const ConnectorProfile& profile) override;
  void unsubscribeInterfaces(const ConnectorProfile& profile) override;

  const std::unique_ptr<detail::DataPortCore> core_;
  // The names of 1.x and 2.x.
  using Guard = coil::Guard<coil::Mutex>;
  detail::ConnectorsView<DataPortBase> m_connectors{*this};
  mutable coil::Mutex m_connectorsMutex;

 private:
  friend class RuntimeAccess;
  template <class Match>
  Connector* find(Match match) const;

  const std::string short_name_;
};

extern template class DataPortBase<InPortConnector>;
extern template class DataPortBase<OutPortConnector>;

}  // namespace RTC
