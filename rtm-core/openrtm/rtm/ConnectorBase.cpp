#include "rtm/ConnectorBase.h"

#include <cstring>

#include "base/guarded.h"
#include "component/runtime_access.h"
#include "corba/transport/transport.h"
#include "rtm/ByteData.h"
#include "rtm/PortBase.h"

namespace RTC {

struct ConnectorBase::Impl {
  PortBase& port;
  // Shared, because a sample may still be on its way when the port dies.
  const std::shared_ptr<ConnectorListeners> listeners;
  base::Guarded<std::shared_ptr<ConnectorInfo>, base::Rank::details> info{};
};

ConnectorBase::ConnectorBase(PortBase& port, std::shared_ptr<ConnectorListeners> listeners, ConnectorInfo info)
    : name_(info.name), id_(info.id), impl_(new Impl{port, std::move(listeners)}) {
  setInfo(std::move(info));
}

ConnectorBase::~ConnectorBase() = default;

ConnectorInfo ConnectorBase::profile() const { return *info(); }
std::shared_ptr<ConnectorInfo> ConnectorBase::info() const { return impl_->info.snapshot(); }
ConnectorListeners& ConnectorBase::listeners() { return *impl_->listeners; }

void ConnectorBase::setInfo(ConnectorInfo info) {
  auto next = std::make_shared<ConnectorInfo>(std::move(info));
  std::swap(*impl_->info.lock(), next);
}

DataPortStatus ConnectorBase::disconnect() {
  const std::string id = id_;  // the connector dies on the way
  return impl_->port.disconnect(id.c_str()) == RTC_OK ? PORT_OK : PORT_ERROR;
}

namespace {

BufferStatus to_buffer_status(rt::PortStatus status) {
  switch (status) {
    case rt::PortStatus::ok:
      return BufferStatus::OK;
    case rt::PortStatus::buffer_full:
      return BufferStatus::FULL;
    case rt::PortStatus::buffer_empty:
      return BufferStatus::EMPTY;
    case rt::PortStatus::buffer_timeout:
      return BufferStatus::TIMEOUT;
    default:
      return BufferStatus::BUFFER_ERROR;
  }
}

}  // namespace

void RuntimeAccess::serve(InPortConnector& connector, const std::weak_ptr<corba::Receiver>& receiver, bool is_little) {
  connector.receiver_ = receiver;
  connector.is_little_ = is_little;
}

BufferStatus InPortConnector::write(const ByteData& data) {
  const auto receiver = std::static_pointer_cast<corba::Receiver>(receiver_.lock());
  if (!receiver) return BufferStatus::PRECONDITION_NOT_MET;
  auto block = receiver->pool().take(data.getDataLength());
  if (block->size() > 0) std::memcpy(block->data(), data.getBuffer(), block->size());
  rt::Sample sample;
  sample.block = std::move(block);
  sample.order = is_little_ ? rt::ByteOrder::little : rt::ByteOrder::big;
  return to_buffer_status(receiver->receive(std::move(sample)));
}

void RuntimeAccess::serve(OutPortConnector& connector, const std::weak_ptr<corba::Source>& source, bool is_little) {
  connector.source_ = source;
  connector.is_little_ = is_little;
}

BufferStatus OutPortConnector::read(ByteData& data) {
  const auto source = std::static_pointer_cast<corba::Source>(source_.lock());
  if (!source) return BufferStatus::PRECONDITION_NOT_MET;
  rt::Sample sample;
  const rt::PortStatus status = source->give(sample);
  if (status != rt::PortStatus::ok) return to_buffer_status(status);
  if (!sample.block) return BufferStatus::BUFFER_ERROR;
  data.setDataLength(sample.block->size());
  if (sample.block->size() > 0) std::memcpy(data.getBuffer(), sample.block->data(), sample.block->size());
  data.setEndian(is_little_);
  return BufferStatus::OK;
}

}  // namespace RTC
