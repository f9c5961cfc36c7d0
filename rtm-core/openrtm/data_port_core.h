// The inside of InPorts and OutPorts behind the facade: corba's data port, the serializers of the type, the listeners. Any thread.
#pragma once

#include <rtm/ConnectorListener.h>
#include <rtm/PortBase.h>
#include <rtm/Serializers.h>

#include <memory>

#include "base/clock.h"
#include "base/guarded.h"
#include "corba/ports/data_port.h"
#include "openrtm/opaque_types.h"

namespace RTC::detail {

// The settings of a connection, with what the port has read in its profile to find them.
struct DataPortTerms final : PortTerms {
  rt::ConnectorSettingsOutcome outcome;
};

class DataPortCore {
 public:
  // The serializers live as long as the port.
  DataPortCore(rt::Side side, std::unique_ptr<corba::DataPort> port, const Serializers& serializers)
      : side_(side), port_(std::move(port)), serializers_(serializers) {}

  rt::Side side() const { return side_; }
  corba::DataPort& port() { return *port_; }
  const corba::DataPort& port() const { return *port_; }
  const Serializers& serializers() const { return serializers_; }
  const std::string& type_id() const { return port_->ops().type_id; }
  const std::shared_ptr<ConnectorListeners>& listeners() const { return listeners_; }
  void set_clock(std::shared_ptr<const base::Clock> clock) { *clock_.lock() = std::move(clock); }

  // Makes the connection when the port publishes its objects, if this side provides one, else when it subscribes to the other's. The
  // connector is the one that users see.
  template <class Connector>
  ReturnCode_t open(PortBase& owner, const coil::Properties& properties, ConnectorProfile& profile, const rt::ConnectorSettings& settings,
                    bool is_publishing, Logger& rtclog) {
    // Whoever receives the calls provides the object.
    const bool is_provider = (settings.dataflow == rt::Dataflow::push) == (side_ == rt::Side::in);
    if (is_provider != is_publishing) return RTC_OK;
    auto connector = std::make_shared<Connector>(owner, listeners_, info(profile, properties));
    return connect(owner, std::move(connector), properties, profile, settings, is_provider, rtclog);
  }
  // The connectors of open(), in the order in which they were made; kept alive by their connections.
  std::vector<ConnectorBase*> connectors() const;

 private:
  ConnectorInfo info(const ConnectorProfile& profile, const coil::Properties& properties) const;
  ReturnCode_t connect(const PortBase& owner, std::shared_ptr<ConnectorBase> connector, const coil::Properties& properties,
                       ConnectorProfile& profile, const rt::ConnectorSettings& settings, bool is_provider, Logger& rtclog);

  const rt::Side side_;
  const std::unique_ptr<corba::DataPort> port_;
  const Serializers& serializers_;
  const std::shared_ptr<ConnectorListeners> listeners_ = std::make_shared<ConnectorListeners>();
  base::Guarded<std::shared_ptr<const base::Clock>, base::Rank::details> clock_;
};

}  // namespace RTC::detail
