#include "rtm/DataPortBase.h"

#include "base/text.h"
#include "corba/in_engine.h"
#include "corba/nv_list.h"
#include "corba/out_engine.h"
#include "openrtm/data_port_support.h"
#include "openrtm/interface_plugins.h"
#include "rtm/Serializers.h"

namespace RTC {

template <class Engine, class Connector, rt::Side side>
DataPortBase<Engine, Connector, side>::DataPortBase(const char* name, std::unique_ptr<Engine> engine,
                                                    const detail::Serializers& serializers)
    : PortBase(name),
      engine_(std::move(engine)),
      short_name_(detail::short_name(name)),
      serializers_(serializers),
      listeners_(std::make_shared<ConnectorListeners>()) {
  for (const auto& [key, value] : detail::advertised_keys(side, engine_->ops().type_id)) addProperty(key, value);
}

template <class Engine, class Connector, rt::Side side>
DataPortBase<Engine, Connector, side>::~DataPortBase() = default;

template <class Engine, class Connector, rt::Side side>
void DataPortBase<Engine, Connector, side>::setClock(std::shared_ptr<const base::Clock> clock) {
  *clock_.lock() = std::move(clock);
}

template <class Engine, class Connector, rt::Side side>
DataPortStatus DataPortBase<Engine, Connector, side>::getStatus(int index) const {
  const auto statuses = engine_->statuses();
  if (index < 0 || static_cast<std::size_t>(index) >= statuses.size()) return UNKNOWN_ERROR;
  return detail::to_classic(statuses[static_cast<std::size_t>(index)]);
}

template <class Engine, class Connector, rt::Side side>
DataPortStatusList DataPortBase<Engine, Connector, side>::getStatusList() const {
  return detail::to_classic(engine_->statuses());
}

template <class Engine, class Connector, rt::Side side>
auto DataPortBase<Engine, Connector, side>::connectors() const -> ConnectorList {
  ConnectorList list;
  const auto all = engine_->connections();  // kept alive during the loop
  for (const auto& connection : *all) list.push_back(static_cast<Connector*>(&connection->events()));
  return list;
}

template <class Engine, class Connector, rt::Side side>
ConnectorInfoList DataPortBase<Engine, Connector, side>::getConnectorProfiles() const {
  ConnectorInfoList list;
  for (const auto* connector : connectors()) list.push_back(connector->profile());
  return list;
}

template <class Engine, class Connector, rt::Side side>
coil::vstring DataPortBase<Engine, Connector, side>::getConnectorIds() const {
  coil::vstring ids;
  for (const auto* connector : connectors()) ids.emplace_back(connector->id());
  return ids;
}

template <class Engine, class Connector, rt::Side side>
coil::vstring DataPortBase<Engine, Connector, side>::getConnectorNames() const {
  coil::vstring names;
  for (const auto* connector : connectors()) names.emplace_back(connector->name());
  return names;
}

template <class Engine, class Connector, rt::Side side>
template <class Match>
Connector* DataPortBase<Engine, Connector, side>::find(Match match) const {
  for (auto* connector : connectors()) {
    if (match(*connector)) return connector;
  }
  return nullptr;
}

template <class Engine, class Connector, rt::Side side>
Connector* DataPortBase<Engine, Connector, side>::getConnectorById(const char* id) const {
  return find([&](const Connector& connector) { return std::string_view(connector.id()) == id; });
}

template <class Engine, class Connector, rt::Side side>
Connector* DataPortBase<Engine, Connector, side>::getConnectorByName(const char* name) const {
  return find([&](const Connector& connector) { return std::string_view(connector.name()) == name; });
}

template <class Engine, class Connector, rt::Side side>
bool DataPortBase<Engine, Connector, side>::getConnectorProfileById(const char* id, ConnectorInfo& info) const {
  const auto* connector = getConnectorById(id);
  if (connector) info = connector->profile();
  return connector;
}

template <class Engine, class Connector, rt::Side side>
bool DataPortBase<Engine, Connector, side>::getConnectorProfileByName(const char* name, ConnectorInfo& info) const {
  const auto* connector = getConnectorByName(name);
  if (connector) info = connector->profile();
  return connector;
}

template <class Engine, class Connector, rt::Side side>
void DataPortBase<Engine, Connector, side>::addConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener,
                                                                     bool autoclean) {
  if (type >= 0 && type < CONNECTOR_DATA_LISTENER_NUM) listeners_->connectorData_[type].addListener(listener, autoclean);
}

template <class Engine, class Connector, rt::Side side>
void DataPortBase<Engine, Connector, side>::removeConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener) {
  if (type >= 0 && type < CONNECTOR_DATA_LISTENER_NUM) listeners_->connectorData_[type].removeListener(listener);
}

template <class Engine, class Connector, rt::Side side>
void DataPortBase<Engine, Connector, side>::addConnectorListener(ConnectorListenerType type, ConnectorListener* listener, bool autoclean) {
  if (type >= 0 && type < CONNECTOR_LISTENER_NUM) listeners_->connector_[type].addListener(listener, autoclean);
}

template <class Engine, class Connector, rt::Side side>
void DataPortBase<Engine, Connector, side>::removeConnectorListener(ConnectorListenerType type, ConnectorListener* listener) {
  if (type >= 0 && type < CONNECTOR_LISTENER_NUM) listeners_->connector_[type].removeListener(listener);
}

template <class Engine, class Connector, rt::Side side>
void DataPortBase<Engine, Connector, side>::complete(PortProfile& profile) const {
  corba::set_text(profile.properties, "dataport.marshaling_types", base::join(serializers_.names(), ","));
  detail::show_interfaces_of_authors(profile, side);
}

template <class Engine, class Connector, rt::Side side>
void DataPortBase<Engine, Connector, side>::complete_profile(ConnectorProfile& profile) {
  detail::complete_data_profile(profile);
}

template <class Engine, class Connector, rt::Side side>
ReturnCode_t DataPortBase<Engine, Connector, side>::prepare(ConnectorProfile& profile) {
  return detail::check_connection(profile, m_properties, side, {engine_->ops().type_id, serializers_.names()}, rtclog);
}

template <class Engine, class Connector, rt::Side side>
bool DataPortBase<Engine, Connector, side>::allows_duplicate(const ConnectorProfile& profile) {
  return detail::settings_of(profile, m_properties, side).settings.allows_duplicate;
}

template <class Engine, class Connector, rt::Side side>
ReturnCode_t DataPortBase<Engine, Connector, side>::publishInterfaces(ConnectorProfile& profile) {
  return open(profile, true);
}

template <class Engine, class Connector, rt::Side side>
ReturnCode_t DataPortBase<Engine, Connector, side>::subscribeInterfaces(const ConnectorProfile& profile) {
  ConnectorProfile copy = profile;
  return open(copy, false);
}

template <class Engine, class Connector, rt::Side side>
ReturnCode_t DataPortBase<Engine, Connector, side>::open(ConnectorProfile& profile, bool provides) {
  const auto settings = detail::settings_of(profile, m_properties, side).settings;
  // Whoever receives the calls provides the object.
  const bool is_provider = (settings.dataflow == rt::Dataflow::push) == (side == rt::Side::in);
  if (is_provider != provides) return RTC_OK;
  auto connector = std::make_shared<Connector>(*this, listeners_, detail::make_info(profile, m_properties, side, engine_->ops().type_id));
  auto plan = detail::make_plan(profile, settings, connector);
  // Inside a process the value itself is handed over.
  if (settings.marshaling != "cdr" && settings.interface != rt::Interface::direct) {
    plan.codec = serializers_.make(settings.marshaling, connector->profile().properties);
    if (!plan.codec) {
      RTC_WARN_STR("connection refused: no serializer can be made for dataport.marshaling_type " << base::in_quotes(settings.marshaling));
      return RTC_ERROR;
    }
  }
  plan.clock = *clock_.lock();
  if (settings.interface == rt::Interface::foreign) plan.carrier = detail::make_author_carrier(settings, connector);
  const rt::Refusal refusal = provides ? engine_->provide(std::move(plan), profile) : engine_->consume(std::move(plan), profile);
  if (refusal.code != rt::ReturnCode::ok) {
    RTC_WARN_STR("connection refused: " << refusal.reason);
    return static_cast<ReturnCode_t>(refusal.code);
  }
  const auto all = engine_->connections();
  for (const auto& connection : *all) {
    if (connection->id() == connector->id()) connector->getBuffer()->show(connection, settings.buffer.length);
  }
  if (provides) connector->setInfo(detail::make_info(profile, m_properties, side, engine_->ops().type_id));
  connector->on_event(corba::ConnectorEvent::connect);
  return RTC_OK;
}

template <class Engine, class Connector, rt::Side side>
void DataPortBase<Engine, Connector, side>::unsubscribeInterfaces(const ConnectorProfile& profile) {
  engine_->close(profile.connector_id.in());
}

template class DataPortBase<corba::InEngine, InPortConnector, rt::Side::in>;
template class DataPortBase<corba::OutEngine, OutPortConnector, rt::Side::out>;

}  // namespace RTC
