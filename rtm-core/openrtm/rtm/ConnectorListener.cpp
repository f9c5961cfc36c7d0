#include "rtm/ConnectorListener.h"

#include <exception>

#include "base/log.h"
#include "component/runtime_access.h"
#include "corba/transport/cdr.h"
#include "openrtm/opaque_types.h"
#include "openrtm/type_names.h"

namespace RTC {
namespace {

template <class Call>
ConnectorListenerStatus::Enum guarded(Call call) {
  try {
    return call();
  } catch (const std::exception& e) {
    base::log(base::Level::error, "data port", "a listener has thrown: {}", e.what());
  } catch (...) {
    base::log(base::Level::error, "data port", "a listener has thrown something that is no std::exception");
  }
  return ConnectorListenerStatus::NO_CHANGE;
}

bool changes_data(ConnectorListenerStatus::Enum status) {
  return status == ConnectorListenerStatus::DATA_CHANGED || status == ConnectorListenerStatus::BOTH_CHANGED;
}
bool changes_info(ConnectorListenerStatus::Enum status) {
  return status == ConnectorListenerStatus::INFO_CHANGED || status == ConnectorListenerStatus::BOTH_CHANGED;
}

}  // namespace

const char* ConnectorDataListener::toString(ConnectorDataListenerType type) {
  static const char* const names[] = {
      "ON_BUFFER_WRITE", "ON_BUFFER_FULL", "ON_BUFFER_WRITE_TIMEOUT", "ON_BUFFER_OVERWRITE", "ON_BUFFER_READ",
      "ON_SEND",         "ON_RECEIVED",    "ON_RECEIVER_FULL",        "ON_RECEIVER_TIMEOUT", "ON_RECEIVER_ERROR"};
  return name_of(names, type);
}

const char* ConnectorListener::toString(ConnectorListenerType type) {
  static const char* const names[] = {"ON_BUFFER_EMPTY",   "ON_BUFFER_READ_TIMEOUT", "ON_SENDER_EMPTY",
                                      "ON_SENDER_TIMEOUT", "ON_SENDER_ERROR",        "ON_CONNECT",
                                      "ON_DISCONNECT"};
  return name_of(names, type);
}

ConnectorDataListener::ReturnCode ConnectorDataListener::operator()(ConnectorInfo& info, ByteData& data, const std::string&) {
  cdrMemoryStream stream;
  stream.setByteSwapFlag(data.isLittleEndian());
  if (data.getDataLength()) stream.put_octet_array(std::as_const(data).getBuffer(), static_cast<int>(data.getDataLength()));
  stream.rewindInputPtr();
  const ReturnCode code = (*this)(info, stream);
  if (changes_data(code)) data.writeData(static_cast<unsigned char*>(stream.bufPtr()), stream.bufSize());
  return code;
}

ConnectorDataListener::ReturnCode ConnectorDataListener::operator()(ConnectorInfo& info, cdrMemoryStream& data) {
  (*this)(std::as_const(info), std::as_const(data));
  return NO_CHANGE;
}

ConnectorDataListener::ReturnCode ConnectorDataListener::notify(ConnectorInfo& info, detail::SampleEvent& sample) {
  auto& data = sample.data;
  ByteData bytes(sample);
  const ReturnCode code = (*this)(info, bytes, data.ops().codec ? data.ops().codec->name() : "cdr");
  if (changes_data(code)) data.replace_octets(std::as_bytes(std::span(std::as_const(bytes).getBuffer(), bytes.getDataLength())));
  return code;
}

detail::TypedDataListener::ReturnCode detail::TypedDataListener::notify(ConnectorInfo& info, detail::SampleEvent& sample) {
  auto& data = sample.data;
  const corba::TypeOps& own = RuntimeAccess::ops(type());
  if (*data.ops().type == *own.type) {
    void* value = data.value();
    if (!value) return NO_CHANGE;
    const ReturnCode code = hear(info, value);
    if (changes_data(code)) data.value_changed();
    return code;
  }
  const auto value = own.make();
  if (!corba::decode(own, value.get(), data.octets(), data.order())) return NO_CHANGE;
  const ReturnCode code = hear(info, value.get());
  if (changes_data(code)) data.replace_octets(corba::encode(own, value.get(), data.order())->octets());
  return code;
}

void ConnectorDataListenerHolder::addListener(ConnectorDataListener* listener, bool autoclean) {
  ListenerSet::addListener(listener, autoclean);
  count_.store(ListenerSet::size(), std::memory_order_relaxed);
}

void ConnectorDataListenerHolder::removeListener(ConnectorDataListener* listener) {
  ListenerSet::removeListener(listener);
  count_.store(ListenerSet::size(), std::memory_order_relaxed);
}

void ConnectorDataListenerHolder::notify(ConnectorInfo& info, detail::SampleEvent& sample, bool& info_changed) {
  for (const auto& listener : snapshot()) {
    const auto status = guarded([&] { return listener->notify(info, sample); });
    info_changed |= changes_info(status);
  }
}

void ConnectorListenerHolder::notify(ConnectorInfo& info, bool& info_changed) {
  for (const auto& listener : snapshot()) {
    const auto status = guarded([&] { return (*listener)(info); });
    info_changed |= changes_info(status);
  }
}

}  // namespace RTC
