// Listeners to the steps of connecting and disconnecting ports. Adding, removing and notifying: any thread. Listeners are called without
// locks, on the thread that connects.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "rtm/idl/RTCStub.h"

namespace RTC {

// Unscoped, so that both PortConnectListenerType::ON_CONNECTED and plain ON_CONNECTED compile.
enum PortConnectListenerType { ON_NOTIFY_CONNECT, ON_NOTIFY_DISCONNECT, ON_UNSUBSCRIBE_INTERFACES, PORT_CONNECT_LISTENER_NUM };
enum PortConnectRetListenerType {
  ON_PUBLISH_INTERFACES,
  ON_CONNECT_NEXTPORT,
  ON_SUBSCRIBE_INTERFACES,
  ON_CONNECTED,
  ON_DISCONNECT_NEXT,
  ON_DISCONNECTED,
  PORT_CONNECT_RET_LISTENER_NUM
};

class PortConnectListener {
 public:
  virtual ~PortConnectListener() = default;
  virtual void operator()(const char* portname, RTC::ConnectorProfile& profile) = 0;
  static const char* toString(PortConnectListenerType type);
};

class PortConnectRetListener {
 public:
  virtual ~PortConnectRetListener() = default;
  virtual void operator()(const char* portname, RTC::ConnectorProfile& profile, ReturnCode_t ret) = 0;
  static const char* toString(PortConnectRetListenerType type);
};

// A set of listeners. One added with autoclean is deleted when it is removed (after the last running notification) or with the holder.
template <class Listener>
class ListenerSet {
 public:
  void addListener(Listener* listener, bool autoclean) {
    if (!listener) return;
    auto owned = autoclean ? std::shared_ptr<Listener>(listener) : std::shared_ptr<Listener>(listener, [](Listener*) {});
    std::lock_guard lock(mutex_);
    listeners_.push_back(std::move(owned));
  }
  void removeListener(Listener* listener) {
    std::shared_ptr<Listener> removed;
    std::lock_guard lock(mutex_);
    for (auto it = listeners_.begin(); it != listeners_.end(); ++it) {
      if (it->get() != listener) continue;
      removed = std::move(*it);
      listeners_.erase(it);
      return;
    }
  }
  std::size_t size() const {
    std::lock_guard lock(mutex_);
    return listeners_.size();
  }
  template <class... Args>
  void notify(Args&&... args) {
    for (auto& listener : snapshot()) (*listener)(args...);
  }

 protected:
  std::vector<std::shared_ptr<Listener>> snapshot() const {
    std::lock_guard lock(mutex_);
    return listeners_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Listener>> listeners_;
};

class PortConnectListenerHolder : public ListenerSet<PortConnectListener> {};
class PortConnectRetListenerHolder : public ListenerSet<PortConnectRetListener> {};

class PortConnectListeners {
 public:
  PortConnectListenerHolder portconnect_[PORT_CONNECT_LISTENER_NUM];
  PortConnectRetListenerHolder portconnret_[PORT_CONNECT_RET_LISTENER_NUM];
};

}  // namespace RTC
