// Listeners to what the manager does: its own end, modules, components, naming. They are called on the thread that does it, without any
// lock; an exception that a listener throws is logged and ignored.
#pragma once

#include <coil/Properties.h>
#include <coil/stringutil.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace RTC {
class RTObject_impl;
}

namespace RTM {

class ManagerActionListener {
 public:
  virtual ~ManagerActionListener() = default;
  virtual void preShutdown() = 0;
  virtual void postShutdown() = 0;
  virtual void preReinit() {}
  virtual void postReinit() {}
};

class ModuleActionListener {
 public:
  virtual ~ModuleActionListener() = default;
  // May change what is loaded.
  virtual void preLoad(std::string& modname, std::string& funcname) = 0;
  virtual void postLoad(std::string& modname, std::string& funcname) = 0;
  virtual void preUnload(std::string& modname) = 0;
  virtual void postUnload(std::string& modname) = 0;
};

class RtcLifecycleActionListener {
 public:
  virtual ~RtcLifecycleActionListener() = default;
  // May change the argument of createComponent.
  virtual void preCreate(std::string& args) = 0;
  virtual void postCreate(RTC::RTObject_impl* rtc) = 0;
  virtual void preConfigure(coil::Properties& properties) = 0;
  virtual void postConfigure(coil::Properties& properties) = 0;
  virtual void preInitialize() = 0;
  virtual void postInitialize() = 0;
};

class NamingActionListener {
 public:
  virtual ~NamingActionListener() = default;
  // May change the names.
  virtual void preBind(RTC::RTObject_impl* rtc, coil::vstring& names) = 0;
  virtual void postBind(RTC::RTObject_impl* rtc, coil::vstring& names) = 0;
  virtual void preUnbind(RTC::RTObject_impl* rtc, coil::vstring& names) = 0;
  virtual void postUnbind(RTC::RTObject_impl* rtc, coil::vstring& names) = 0;
};

class LocalServiceBase;

class LocalServiceActionListener {
 public:
  virtual ~LocalServiceActionListener() = default;
  virtual void preServiceRegister(std::string service_name) = 0;
  virtual void postServiceRegister(std::string service_name, LocalServiceBase* service) = 0;
  virtual void preServiceInit(coil::Properties& properties, LocalServiceBase* service) = 0;
  virtual void postServiceInit(coil::Properties& properties, LocalServiceBase* service) = 0;
  virtual void preServiceReinit(coil::Properties& properties, LocalServiceBase* service) = 0;
  virtual void postServiceReinit(coil::Properties& properties, LocalServiceBase* service) = 0;
  virtual void postServiceFinalize(std::string service_name, LocalServiceBase* service) = 0;
};

namespace detail {
// Logs the exception in flight.
void log_listener_exception();
}  // namespace detail

// The listeners of one kind. Any thread.
template <class Listener>
class ListenerHolder {
 public:
  // autoclean: the holder deletes the listener when it is removed or the holder dies.
  void addListener(Listener* listener, bool autoclean) {
    const std::scoped_lock lock(mutex_);
    listeners_.emplace_back(listener, [autoclean](Listener* doomed) {
      if (autoclean) delete doomed;
    });
  }

  void removeListener(Listener* listener) {
    std::vector<std::shared_ptr<Listener>> before;  // a listener that is deleted is deleted without the lock
    const std::scoped_lock lock(mutex_);
    before = listeners_;
    listeners_.erase(std::remove_if(listeners_.begin(), listeners_.end(), [&](const auto& held) { return held.get() == listener; }),
                     listeners_.end());
  }

  // Calls one member function of every listener; arguments are handed on by reference.
  template <class... Parameters, class... Arguments>
  void call(void (Listener::*function)(Parameters...), Arguments&&... arguments) {
    std::vector<std::shared_ptr<Listener>> listeners;
    {
      const std::scoped_lock lock(mutex_);
      listeners = listeners_;
    }
    for (const auto& listener : listeners) {
      try {
        (listener.get()->*function)(arguments...);
      } catch (...) {
        detail::log_listener_exception();
      }
    }
  }

 private:
  std::mutex mutex_;
  std::vector<std::shared_ptr<Listener>> listeners_;
};

using ManagerActionListenerHolder = ListenerHolder<ManagerActionListener>;
using ModuleActionListenerHolder = ListenerHolder<ModuleActionListener>;
using RtcLifecycleActionListenerHolder = ListenerHolder<RtcLifecycleActionListener>;
using NamingActionListenerHolder = ListenerHolder<NamingActionListener>;
using LocalServiceActionListenerHolder = ListenerHolder<LocalServiceActionListener>;

struct ManagerActionListeners {
  ManagerActionListenerHolder manager_;
  ModuleActionListenerHolder module_;
  RtcLifecycleActionListenerHolder rtclifecycle_;
  NamingActionListenerHolder naming_;
  LocalServiceActionListenerHolder localservice_;
};

}  // namespace RTM
