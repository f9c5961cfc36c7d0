#include "rtm/DataPortBase.h"

#include "base/text.h"
#include "component/runtime_access.h"
#include "corba/orb/nv_list.h"
#include "openrtm/data_port_core.h"
#include "openrtm/data_port_support.h"

namespace RTC {

namespace {
const detail::DataPortTerms& of_data_port(const detail::PortTerms& terms) { return static_cast<const detail::DataPortTerms&>(terms); }
}  // namespace

template <class Connector>
DataPortBase<Connector>::DataPortBase(const char* name, std::unique_ptr<detail::DataPortCore> core)
    : PortBase(name), core_(std::move(core)), short_name_(detail::short_name(name)) {
  for (const auto& [key, value] : detail::advertised_keys(core_->side(), core_->type_id())) addProperty(key, value);
}

template <class Connector>
DataPortBase<Connector>::~DataPortBase() = default;

void RuntimeAccess::set_clock(DataPortBase<InPortConnector>& port, std::shared_ptr<const base::Clock> clock) {
  port.core_->set_clock(std::move(clock));
}

void RuntimeAccess::set_clock(DataPortBase<OutPortConnector>& port, std::shared_ptr<const base::Clock> clock) {
  port.core_->set_clock(std::move(clock));
}

template <class Connector>
DataPortStatus DataPortBase<Connector>::getStatus(int index) const {
  const auto statuses = core_->port().statuses();
  if (index < 0 || static_cast<std::size_t>(index) >= statuses.size()) return UNKNOWN_ERROR;
  return detail::to_classic(statuses[static_cast<std::size_t>(index)]);
}

template <class Connector>
DataPortStatusList DataPortBase<Connector>::getStatusList() const {
  return detail::to_classic(core_->port().statuses());
}

template <class Connector>
auto DataPortBase<Connector>::connectors() const -> ConnectorList {
  ConnectorList list;
  for (ConnectorBase* connector : core_->connectors()) list.push_back(static_cast<Connector*>(connector));
  return list;
}

template <class Connector>
ConnectorInfoList DataPortBase<Connector>::getConnectorProfiles() const {
  ConnectorInfoList list;
  for (const auto* connector : connectors()) list.push_back(connector->profile());
  return list;
}

template <class Connector>
coil::vstring DataPortBase<Connector>::getConnectorIds() const {
  coil::vstring ids;
  for (const auto* connector : connectors()) ids.emplace_back(connector->id());
  return ids;
}

template <class Connector>
coil::vstring DataPortBase<Connector>::getConnectorNames() const {
  coil::vstring names;
  for (const auto* connector : connectors()) names.emplace_back(connector->name());
  return names;
}

template <class Connector>
template <class Match>
Connector* DataPortBase<Connector>::find(Match match) const {
  for (auto* connector : connectors()) {
    if (match(*connector)) return connector;
  }
  return nullptr;
}

template <class Connector>
Connector* DataPortBase<Connector>::getConnectorById(const char* id) const {
  return find([&](const Connector& connector) { return std::string_view(connector.id()) == id; });
}

template <class Connector>
Connector* DataPortBase<Connector>::getConnectorByName(const char* name) const {
  return find([&](const Connector& connector) { return std::string_view(connector.name()) == name; });
}

template <class Connector>
bool DataPortBase<Connector>::getConnectorProfileById(const char* id, ConnectorInfo& info) const {
  const auto* connector = getConnectorById(id);
  if (connector) info = connector->profile();
  return connector;
}

template <class Connector>
bool DataPortBase<Connector>::getConnectorProfileByName(const char* name, ConnectorInfo& info) const {
  const auto* connector = getConnectorByName(name);
  if (connector) info = connector->profile();
  return connector;
}

template <class Connector>
void DataPortBase<Connector>::addConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener, bool autoclean) {
  if (type >= 0 && type < CONNECTOR_DATA_LISTENER_NUM) core_->listeners()->connectorData_[type].addListener(listener, autoclean);
}

template <class Connector>
void DataPortBase<Connector>::removeConnectorDataListener(ConnectorDataListenerType type, ConnectorDataListener* listener) {
  if (type >= 0 && type < CONNECTOR_DATA_LISTENER_NUM) core_->listeners()->connectorData_[type].removeListener(listener);
}

template <class Connector>
void DataPortBase<Connector>::addConnectorListener(ConnectorListenerType type, ConnectorListener* listener, bool autoclean) {
  if (type >= 0 && type < CONNECTOR_LISTENER_NUM) core_->listeners()->connector_[type].addListener(listener, autoclean);
}

template <class Connector>
void DataPortBase<Connector>::removeConnectorListener(ConnectorListenerType type, ConnectorListener* listener) {
  if (type >= 0 && type < CONNECTOR_LISTENER_NUM) core_->listeners()->connector_[type].removeListener(listener);
}

template <class Connector>
ConnectorListeners& DataPortBase<Connector>::getListeners() {
  return *core_->listeners();
}

template <class Connector>
void DataPortBase<Connector>::complete(PortProfile& profile) const {
  corba::set_text(profile.properties, "dataport.marshaling_types", base::join(core_->serializers().names(), ","));
  detail::show_interfaces_of_authors(profile, core_->side());
}

template <class Connector>
void DataPortBase<Connector>::complete_profile(ConnectorProfile& profile) {
  detail::complete_data_profile(profile);
}

template <class Connector>
std::shared_ptr<detail::PortTerms> DataPortBase<Connector>::read_terms(const ConnectorProfile& profile) {
  auto terms = std::make_shared<detail::DataPortTerms>();
  terms->outcome = detail::settings_of(profile, m_properties, core_->side());
  terms->allows_duplicate = terms->outcome.settings.allows_duplicate;
  return terms;
}

template <class Connector>
ReturnCode_t DataPortBase<Connector>::prepare(ConnectorProfile& profile, const detail::PortTerms& terms) {
  const auto& outcome = of_data_port(terms).outcome;
  return detail::check_connection(profile, outcome, core_->side(), {core_->type_id(), core_->serializers().names()}, rtclog);
}

template <class Connector>
ReturnCode_t DataPortBase<Connector>::publish(ConnectorProfile& profile, const detail::PortTerms& terms) {
  return core_->template open<Connector>(*this, m_properties, profile, of_data_port(terms).outcome.settings, true, rtclog);
}

template <class Connector>
ReturnCode_t DataPortBase<Connector>::subscribe(const ConnectorProfile& profile, const detail::PortTerms& terms) {
  ConnectorProfile copy = profile;
  return core_->template open<Connector>(*this, m_properties, copy, of_data_port(terms).outcome.settings, false, rtclog);
}

template <class Connector>
ReturnCode_t DataPortBase<Connector>::publishInterfaces(ConnectorProfile& profile) {
  return publish(profile, *read_terms(profile));
}

template <class Connector>
ReturnCode_t DataPortBase<Connector>::subscribeInterfaces(const ConnectorProfile& profile) {
  return subscribe(profile, *read_terms(profile));
}

template <class Connector>
void DataPortBase<Connector>::unsubscribeInterfaces(const ConnectorProfile& profile) {
  core_->port().close(profile.connector_id.in());
}

template class DataPortBase<InPortConnector>;
template class DataPortBase<OutPortConnector>;

}  // namespace RTC
