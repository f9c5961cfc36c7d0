// Listeners to what happens to samples and connections. Listeners are called without locks on the thread that writes, sends, receives or
// reads; adding and removing: any thread. Nothing is decoded unless a listener asks for it.
#pragma once

#include <atomic>
#include <string>
#include <utility>

#include "rtm/ByteData.h"
#include "rtm/ConnectorBase.h"
#include "rtm/DataType.h"
#include "rtm/PortConnectListener.h"

namespace RTC {

// Unscoped, so that both ConnectorDataListenerType::ON_SEND and plain ON_SEND compile.
enum ConnectorDataListenerType {
  ON_BUFFER_WRITE = 0,
  ON_BUFFER_FULL,
  ON_BUFFER_WRITE_TIMEOUT,
  ON_BUFFER_OVERWRITE,
  ON_BUFFER_READ,
  ON_SEND,
  ON_RECEIVED,
  ON_RECEIVER_FULL,
  ON_RECEIVER_TIMEOUT,
  ON_RECEIVER_ERROR,
  CONNECTOR_DATA_LISTENER_NUM
};

enum ConnectorListenerType {
  ON_BUFFER_EMPTY = 0,
  ON_BUFFER_READ_TIMEOUT,
  ON_SENDER_EMPTY,
  ON_SENDER_TIMEOUT,
  ON_SENDER_ERROR,
  ON_CONNECT,
  ON_DISCONNECT,
  CONNECTOR_LISTENER_NUM
};

// What a listener changed of its arguments. INFO_CHANGED: the new properties stay with the connection; DATA_CHANGED: the sample travels on
// as the listener left it. A base of the listeners.
class ConnectorListenerStatus {
 public:
  enum Enum { NO_CHANGE = 0, INFO_CHANGED, DATA_CHANGED, BOTH_CHANGED };
};

// The names for a listener's own scope, also one that is a template: there those of its bases are not found.
#define USE_CONNLISTENER_STATUS                            \
  typedef ::RTC::ConnectorListenerStatus::Enum ReturnCode; \
  using ::RTC::ConnectorListenerStatus::NO_CHANGE;         \
  using ::RTC::ConnectorListenerStatus::INFO_CHANGED;      \
  using ::RTC::ConnectorListenerStatus::DATA_CHANGED;      \
  using ::RTC::ConnectorListenerStatus::BOTH_CHANGED

// A raw listener overrides one of the three call operators.
class ConnectorDataListener : public ConnectorListenerStatus {
 public:
  USE_CONNLISTENER_STATUS;
  virtual ~ConnectorDataListener() = default;
  // 2.x.
  virtual ReturnCode operator()(ConnectorInfo& info, ByteData& data, const std::string& marshalingtype);
  // 1.2: the stream is at the start of the payload and knows its byte order.
  virtual ReturnCode operator()(ConnectorInfo& info, cdrMemoryStream& data);
  // 1.1: nothing can be changed.
  virtual void operator()(const ConnectorInfo&, const cdrMemoryStream&) {}
  // What ports call.
  virtual ReturnCode notify(ConnectorInfo& info, detail::SampleEvent& sample);
  static const char* toString(ConnectorDataListenerType type);
};

namespace detail {
// A listener that sees values of one type; on a port of another type, if its octets fit.
class TypedDataListener : public ConnectorDataListener {
 public:
  USE_CONNLISTENER_STATUS;
  ReturnCode notify(ConnectorInfo& info, detail::SampleEvent& sample) override;

 private:
  virtual const DataType& type() const = 0;
  virtual ReturnCode hear(ConnectorInfo& info, void* value) = 0;
};
}  // namespace detail

template <class DataType>
class ConnectorDataListenerT : public detail::TypedDataListener {
 public:
  USE_CONNLISTENER_STATUS;
  using ConnectorDataListener::operator();
  // A listener overrides one of the two: 1.2 and 2.x, 1.1.
  virtual ReturnCode operator()(ConnectorInfo& info, DataType& data) {
    (*this)(std::as_const(info), std::as_const(data));
    return NO_CHANGE;
  }
  virtual void operator()(const ConnectorInfo&, const DataType&) {}

 private:
  const detail::DataType& type() const override { return detail::data_type<DataType>(); }
  ReturnCode hear(ConnectorInfo& info, void* value) override { return (*this)(info, *static_cast<DataType*>(value)); }
};

class ConnectorListener : public ConnectorListenerStatus {
 public:
  USE_CONNLISTENER_STATUS;
  virtual ~ConnectorListener() = default;
  // A listener overrides one of the two: 1.2 and 2.x, 1.1.
  virtual ReturnCode operator()(ConnectorInfo& info) {
    (*this)(std::as_const(info));
    return NO_CHANGE;
  }
  virtual void operator()(const ConnectorInfo&) {}
  static const char* toString(ConnectorListenerType type);
};

class ConnectorDataListenerHolder : private ListenerSet<ConnectorDataListener> {
 public:
  void addListener(ConnectorDataListener* listener, bool autoclean);
  void removeListener(ConnectorDataListener* listener);
  std::size_t size() const { return ListenerSet::size(); }
  bool isEmpty() const { return count_.load(std::memory_order_relaxed) == 0; }
  void notify(ConnectorInfo& info, detail::SampleEvent& sample, bool& info_changed);

 private:
  std::atomic<std::size_t> count_{0};
};

class ConnectorListenerHolder : private ListenerSet<ConnectorListener> {
 public:
  using ListenerSet::addListener;
  using ListenerSet::removeListener;
  using ListenerSet::size;
  bool isEmpty() const { return size() == 0; }
  void notify(ConnectorInfo& info, bool& info_changed);
};

// The listeners of one port.
class ConnectorListeners {
 public:
  ConnectorDataListenerHolder connectorData_[CONNECTOR_DATA_LISTENER_NUM];
  ConnectorListenerHolder connector_[CONNECTOR_LISTENER_NUM];

  // Transports of authors call these when something happens. Listeners hear of it from the port already, so nobody is told twice.
  ConnectorListenerStatus::Enum notifyIn(ConnectorDataListenerType, ConnectorInfo&, ByteData&) {
    return ConnectorListenerStatus::NO_CHANGE;
  }
  ConnectorListenerStatus::Enum notifyOut(ConnectorDataListenerType, ConnectorInfo&, ByteData&) {
    return ConnectorListenerStatus::NO_CHANGE;
  }
  ConnectorListenerStatus::Enum notify(ConnectorListenerType, ConnectorInfo&) { return ConnectorListenerStatus::NO_CHANGE; }
};
using ConnectorListenersBase = ConnectorListeners;

}  // namespace RTC
