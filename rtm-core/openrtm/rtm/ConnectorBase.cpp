#include "rtm/ConnectorBase.h"

#include "rtm/ConnectorListener.h"
#include "rtm/PortBase.h"

namespace RTC {

static_assert(static_cast<int>(corba::DataEvent::receiver_error) == ON_RECEIVER_ERROR);
static_assert(static_cast<int>(corba::ConnectorEvent::disconnect) == ON_DISCONNECT);

ConnectorBase::ConnectorBase(PortBase& port, std::shared_ptr<ConnectorListeners> listeners, ConnectorInfo info)
    : port_(port),
      listeners_(std::move(listeners)),
      name_(info.name),
      id_(info.id),
      info_(std::make_shared<ConnectorInfo>(std::move(info))) {}

std::shared_ptr<ConnectorInfo> ConnectorBase::info() const {
  std::lock_guard lock(mutex_);
  return info_;
}

void ConnectorBase::setInfo(ConnectorInfo info) {
  auto next = std::make_shared<ConnectorInfo>(std::move(info));
  std::lock_guard lock(mutex_);
  info_ = std::move(next);
}

DataPortStatus ConnectorBase::disconnect() {
  const std::string id = id_;  // the connector dies on the way
  return port_.disconnect(id.c_str()) == RTC_OK ? PORT_OK : PORT_ERROR;
}

bool ConnectorBase::is_observed(corba::DataEvent event) const { return !listeners_->connectorData_[static_cast<int>(event)].isEmpty(); }

void ConnectorBase::on_data(corba::DataEvent event, corba::EventData& data) {
  const auto current = info();
  bool info_changed = false;  // in place: it is the connection's own
  listeners_->connectorData_[static_cast<int>(event)].notify(*current, data, info_changed);
}

void ConnectorBase::on_event(corba::ConnectorEvent event) {
  auto& holder = listeners_->connector_[static_cast<int>(event)];
  if (holder.isEmpty()) return;
  const auto current = info();
  bool info_changed = false;
  holder.notify(*current, info_changed);
}

}  // namespace RTC
