#include "rtm/OutPortBase.h"

#include "corba/out_engine.h"
#include "rtm/data_port_support.h"

namespace RTC {
namespace {

constexpr rt::Side side = rt::Side::out;

}  // namespace

OutPortBase::OutPortBase(const char* name, const corba::TypeOps& type)
    : PortBase(name),
      short_name_(detail::short_name(name)),
      listeners_(std::make_shared<ConnectorListeners>()),
      engine_(std::make_unique<corba::OutEngine>(type, [this](const std::string& id) { drop_connection(id.c_str()); })) {
  for (const auto& [key, value] : detail::advertised_keys(side, type.type_id)) addProperty(key, value);
}

OutPortBase::~OutPortBase() { retire(); }

void OutPortBase::retire() {
  engine_->stop_telling();
  shut();
}

bool OutPortBase::writeValue(const void* value) { return engine_->write(value); }

ReturnCode_t OutPortBase::prepare(ConnectorProfile& profile) {
  const auto settings = detail::settings_of(profile, m_properties, side).settings;
  if (engine_->connections()->size() >= settings.fan_out) {
    RTC_WARN_STR("connection refused: the port has " << settings.fan_out << " connections already, as many as dataport.fan_out allows");
    return RTC::RTC_ERROR;
  }
  return detail::check_connection(profile, m_properties, side, engine_->ops().type_id, rtclog);
}

void OutPortBase::init(coil::Properties& properties) { PortBase::init(properties); }

DataPortStatus OutPortBase::getStatus(int index) const {
  const auto statuses = engine_->statuses();
  if (index < 0 || static_cast<std::size_t>(index) >= statuses.size()) return UNKNOWN_ERROR;
  return detail::to_classic(statuses[static_cast<std::size_t>(index)]);
}

DataPortStatusList OutPortBase::getStatusList() const { return detail::to_classic(engine_->statuses()); }

OutPortBase::ConnectorList OutPortBase::connectors() const {
  ConnectorList list;
  const auto all = engine_->connections();  // kept alive during the loop
  for (const auto& connection : *all) list.push_back(static_cast<OutPortConnector*>(&connection->events()));
  return list;
}

ConnectorInfoList OutPortBase::getConnectorProfiles() const {
  ConnectorInfoList list;
  for (const auto* connector : connectors()) list.push_back(connector->profile());
  return list;
}

coil::vstring OutPortBase::getConnectorIds() const {
  coil::vstring ids;
  for (const auto* connector : connectors()) ids.emplace_back(connector->id());
  return ids;
}

coil::vstring OutPortBase::getConnectorNames() const {
  coil::vstring names;
  for (const auto* connector : connectors()) names.emplace_back(connector->name());
  return names;
}

OutPortConnector* OutPortBase::getConnectorById(const char* id) const {
  for (auto* connector : connectors()) {
    if (std::string_view(connector->id()) == id) return connector;
  }
  return nullptr;
}

OutPortConnector* OutPortBase::getConnectorByName(const char* name) const {
  for (auto* connector : connectors()) {
    if (std::string_view(connector->name()) == name) return connector;
  }
  return nullptr;
}

bool OutPortBase::getConnectorProfileById(const char* id, ConnectorInfo& info) const {
  const auto* connector = getConnectorById(id);
  if (connector) info = connector->profile();
  return connector;
}

bool OutPortBase::getConnectorProfileByName(const char* name, ConnectorInfo& info) const {
  const auto* connector = getConnectorByName(name);
  if (connector) info = connector->profile();
  return connector;
}

void OutPortBase::addConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener, bool autoclean) {
  if (type >= 0 && type < CONNECTOR_DATA_LISTENER_NUM) listeners_->connectorData_[type].addListener(listener, autoclean);
}

void OutPortBase::removeConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener) {
  if (type >= 0 && type < CONNECTOR_DATA_LISTENER_NUM) listeners_->connectorData_[type].removeListener(listener);
}

void OutPortBase::addConnectorListener(ConnectorListenerType type, ConnectorListener* listener, bool autoclean) {
  if (type >= 0 && type < CONNECTOR_LISTENER_NUM) listeners_->connector_[type].addListener(listener, autoclean);
}

void OutPortBase::removeConnectorListener(ConnectorListenerType type, ConnectorListener* listener) {
  if (type >= 0 && type < CONNECTOR_LISTENER_NUM) listeners_->connector_[type].removeListener(listener);
}

void OutPortBase::complete_profile(ConnectorProfile& profile) { detail::complete_data_profile(profile); }

bool OutPortBase::allows_duplicate(const ConnectorProfile& profile) {
  return detail::settings_of(profile, m_properties, side).settings.allows_duplicate;
}

ReturnCode_t OutPortBase::publishInterfaces(ConnectorProfile& profile) { return open(profile, true); }

ReturnCode_t OutPortBase::subscribeInterfaces(const ConnectorProfile& profile) {
  ConnectorProfile copy = profile;
  return open(copy, false);
}

ReturnCode_t OutPortBase::open(ConnectorProfile& profile, bool provides) {
  const auto settings = detail::settings_of(profile, m_properties, side).settings;
  if ((settings.dataflow == rt::Dataflow::pull) != provides) return RTC_OK;
  auto connector = std::make_shared<OutPortConnector>(*this, listeners_, detail::make_info(profile, m_properties));
  auto plan = detail::make_plan(profile, settings, connector);
  const rt::Refusal refusal = provides ? engine_->provide(std::move(plan), profile) : engine_->consume(std::move(plan), profile);
  if (refusal.code != rt::ReturnCode::ok) {
    RTC_WARN_STR("connection refused: " << refusal.reason);
    return static_cast<ReturnCode_t>(refusal.code);
  }
  if (provides) connector->setInfo(detail::make_info(profile, m_properties));
  connector->on_event(corba::ConnectorEvent::connect);
  return RTC_OK;
}

void OutPortBase::unsubscribeInterfaces(const ConnectorProfile& profile) { engine_->close(profile.connector_id.in()); }

}  // namespace RTC
