#include "openrtm/data_port_core.h"

#include "base/text.h"
#include "component/runtime_access.h"
#include "openrtm/data_port_support.h"
#include "openrtm/interface_plugins.h"
#include "openrtm/serializer_codec.h"

namespace RTC::detail {
namespace {

static_assert(static_cast<int>(corba::DataEvent::receiver_error) == ON_RECEIVER_ERROR);
static_assert(static_cast<int>(corba::ConnectorEvent::disconnect) == ON_DISCONNECT);

// Tells the listeners of a connection what happens to it; keeps its connector.
class ListenerEvents final : public corba::ConnectorEvents {
 public:
  // The listeners live as long as the connector.
  explicit ListenerEvents(std::shared_ptr<ConnectorBase> connector)
      : connector_(std::move(connector)), listeners_(RuntimeAccess::listeners(*connector_)) {}

  ConnectorBase& connector() const { return *connector_; }

  bool is_observed(corba::DataEvent event) const override { return !listeners_.connectorData_[static_cast<int>(event)].isEmpty(); }
  void on_data(corba::DataEvent event, corba::EventData& data) override {
    const auto current = RuntimeAccess::info(*connector_);
    SampleEvent sample{data};
    bool info_changed = false;  // in place: it is the connection's own
    listeners_.connectorData_[static_cast<int>(event)].notify(*current, sample, info_changed);
  }
  void on_event(corba::ConnectorEvent event) override {
    auto& holder = listeners_.connector_[static_cast<int>(event)];
    if (holder.isEmpty()) return;
    const auto current = RuntimeAccess::info(*connector_);
    bool info_changed = false;
    holder.notify(*current, info_changed);
  }

 private:
  const std::shared_ptr<ConnectorBase> connector_;
  ConnectorListeners& listeners_;
};

}  // namespace

std::vector<ConnectorBase*> DataPortCore::connectors() const {
  std::vector<ConnectorBase*> all;
  for (const auto& connected : port_->connected()) all.push_back(&static_cast<ListenerEvents&>(*connected.events).connector());
  return all;
}

ConnectorInfo DataPortCore::info(const ConnectorProfile& profile, const coil::Properties& properties) const {
  return make_info(profile, properties, side_, type_id());
}

ReturnCode_t DataPortCore::connect(const PortBase& owner, std::shared_ptr<ConnectorBase> connector, const coil::Properties& properties,
                                   ConnectorProfile& profile, const rt::ConnectorSettings& settings, bool is_provider, Logger& rtclog) {
  const auto events = std::make_shared<ListenerEvents>(connector);
  corba::ConnectionPlan plan;
  plan.id = connector->id();
  plan.name = connector->name();
  plan.port = owner.getName();
  plan.settings = settings;
  plan.events = events;
  plan.peer_says_when_empty = side_ == rt::Side::in && settings.dataflow == rt::Dataflow::pull && says_when_empty(profile);
  plan.clock = clock_.snapshot();
  // Inside a process the value itself is handed over.
  if (settings.marshaling != "cdr" && settings.interface != rt::Interface::direct) {
    plan.codec = make_codec(serializers_, settings.marshaling, connector->profile().properties);
    if (!plan.codec) {
      log_refused_connection(rtclog, "no serializer can be made for dataport.marshaling_type " + base::in_quotes(settings.marshaling));
      return RTC_ERROR;
    }
  }
  if (settings.interface == rt::Interface::foreign) plan.carrier = make_author_carrier(settings, connector);
  const rt::Refusal refusal = is_provider ? port_->provide(std::move(plan), profile) : port_->consume(std::move(plan), profile);
  if (refusal.code != rt::ReturnCode::ok) {
    log_refused_connection(rtclog, refusal.reason);
    return static_cast<ReturnCode_t>(refusal.code);
  }
  for (const auto& connected : port_->connected()) {
    if (connected.events == events) RuntimeAccess::show(*connector->getBuffer(), connected.waiting, settings.buffer.length);
  }
  if (is_provider) RuntimeAccess::set_info(*connector, info(profile, properties));
  events->on_event(corba::ConnectorEvent::connect);
  return RTC_OK;
}

}  // namespace RTC::detail
