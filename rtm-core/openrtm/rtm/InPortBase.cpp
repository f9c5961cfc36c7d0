#include "rtm/InPortBase.h"

#include "corba/in_engine.h"
#include "rtm/data_port_support.h"

namespace RTC {
namespace {

constexpr rt::Side side = rt::Side::in;

}  // namespace

InPortBase::InPortBase(const char* name, const corba::TypeOps& type)
    : PortBase(name),
      short_name_(detail::short_name(name)),
      listeners_(std::make_shared<ConnectorListeners>()),
      engine_(std::make_unique<corba::InEngine>(type)) {
  for (const auto& [key, value] : detail::advertised_keys(side, type.type_id)) addProperty(key, value);
}

InPortBase::~InPortBase() { retire(); }

void InPortBase::retire() { shut(); }

bool InPortBase::isNew() { return isNew(std::string()); }

bool InPortBase::isNew(const std::string& connector_name) {
  std::vector<std::string> lost;
  const bool is_new = engine_->has_new(connector_name, lost);
  for (const auto& id : lost) drop_connection(id.c_str());
  return is_new;
}

bool InPortBase::isNew(coil::vstring& connector_names) {
  connector_names.clear();
  for (const auto& name : getConnectorNames()) {
    if (isNew(name)) connector_names.push_back(name);
  }
  return !connector_names.empty();
}

bool InPortBase::readValue(const std::string& connector_name, void* value) {
  std::vector<std::string> lost;
  const rt::PortStatus status = engine_->read(connector_name, value, lost);
  for (const auto& id : lost) drop_connection(id.c_str());
  return status == rt::PortStatus::ok;
}

ReturnCode_t InPortBase::prepare(ConnectorProfile& profile) {
  return detail::check_connection(profile, m_properties, side, engine_->ops().type_id, rtclog);
}

void InPortBase::init(coil::Properties& properties) { PortBase::init(properties); }

DataPortStatus InPortBase::getStatus(int index) const {
  const auto statuses = engine_->statuses();
  if (index < 0 || static_cast<std::size_t>(index) >= statuses.size()) return UNKNOWN_ERROR;
  return detail::to_classic(statuses[static_cast<std::size_t>(index)]);
}

DataPortStatusList InPortBase::getStatusList() const { return detail::to_classic(engine_->statuses()); }

InPortBase::ConnectorList InPortBase::connectors() const {
  ConnectorList list;
  const auto all = engine_->connections();  // kept alive during the loop
  for (const auto& connection : *all) list.push_back(static_cast<InPortConnector*>(&connection->events()));
  return list;
}

ConnectorInfoList InPortBase::getConnectorProfiles() const {
  ConnectorInfoList list;
  for (const auto* connector : connectors()) list.push_back(connector->profile());
  return list;
}

coil::vstring InPortBase::getConnectorIds() const {
  coil::vstring ids;
  for (const auto* connector : connectors()) ids.emplace_back(connector->id());
  return ids;
}

coil::vstring InPortBase::getConnectorNames() const {
  coil::vstring names;
  for (const auto* connector : connectors()) names.emplace_back(connector->name());
  return names;
}

InPortConnector* InPortBase::getConnectorById(const char* id) const {
  for (auto* connector : connectors()) {
    if (std::string_view(connector->id()) == id) return connector;
  }
  return nullptr;
}

InPortConnector* InPortBase::getConnectorByName(const char* name) const {
  for (auto* connector : connectors()) {
    if (std::string_view(connector->name()) == name) return connector;
  }
  return nullptr;
}

bool InPortBase::getConnectorProfileById(const char* id, ConnectorInfo& info) const {
  const auto* connector = getConnectorById(id);
  if (connector) info = connector->profile();
  return connector;
}

bool InPortBase::getConnectorProfileByName(const char* name, ConnectorInfo& info) const {
  const auto* connector = getConnectorByName(name);
  if (connector) info = connector->profile();
  return connector;
}

void InPortBase::addConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener, bool autoclean) {
  if (type >= 0 && type < CONNECTOR_DATA_LISTENER_NUM) listeners_->connectorData_[type].addListener(listener, autoclean);
}

void InPortBase::removeConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener) {
  if (type >= 0 && type < CONNECTOR_DATA_LISTENER_NUM) listeners_->connectorData_[type].removeListener(listener);
}

void InPortBase::addConnectorListener(ConnectorListenerType type, ConnectorListener* listener, bool autoclean) {
  if (type >= 0 && type < CONNECTOR_LISTENER_NUM) listeners_->connector_[type].addListener(listener, autoclean);
}

void InPortBase::removeConnectorListener(ConnectorListenerType type, ConnectorListener* listener) {
  if (type >= 0 && type < CONNECTOR_LISTENER_NUM) listeners_->connector_[type].removeListener(listener);
}

void InPortBase::complete_profile(ConnectorProfile& profile) { detail::complete_data_profile(profile); }

bool InPortBase::allows_duplicate(const ConnectorProfile& profile) {
  return detail::settings_of(profile, m_properties, side).settings.allows_duplicate;
}

ReturnCode_t InPortBase::publishInterfaces(ConnectorProfile& profile) { return open(profile, true); }

ReturnCode_t InPortBase::subscribeInterfaces(const ConnectorProfile& profile) {
  ConnectorProfile copy = profile;
  return open(copy, false);
}

ReturnCode_t InPortBase::open(ConnectorProfile& profile, bool provides) {
  const auto settings = detail::settings_of(profile, m_properties, side).settings;
  if ((settings.dataflow == rt::Dataflow::push) != provides) return RTC_OK;
  auto connector = std::make_shared<InPortConnector>(*this, listeners_, detail::make_info(profile, m_properties));
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

void InPortBase::unsubscribeInterfaces(const ConnectorProfile& profile) { engine_->close(profile.connector_id.in()); }

}  // namespace RTC
