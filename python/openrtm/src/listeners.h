// Python functions as listeners of the runtime. Each is called with the interpreter's lock on the thread of the event; what it raises is
// logged with its traceback, within the limits of complaint.h. Registering: with the lock.
#pragma once

#include <pybind11/pybind11.h>
#include <rtm/ConnectorListener.h>
#include <rtm/PortBase.h>

#include <memory>
#include <string>

#include "gil.h"

namespace python {

// A function to be called from any thread.
class Function {
 public:
  explicit Function(const pybind11::object& function) : function_(std::make_shared<Kept>(function.ptr())) {}
  PyObject* get() const { return function_->get(); }

 private:
  std::shared_ptr<Kept> function_;
};

// Calls it with the lock held; Raised with the traceback when it raises.
pybind11::object call(const Function& function, pybind11::tuple arguments);

pybind11::object python_info(const RTC::ConnectorInfo& info);

// function(info, octets, is_little) -> status, or (status, octets).
std::unique_ptr<RTC::ConnectorDataListener> make_data_listener(const pybind11::object& function);
// function(info) -> status.
std::unique_ptr<RTC::ConnectorListener> make_listener(const pybind11::object& function);
// `which`: 0 publish, 1 subscribe, 2 connected, 3 unsubscribe, 4 disconnected, 5 lost. function(profile).
void set_connection_callback(RTC::PortBase& port, int which, const pybind11::object& function);

template <class Port>
void add_data_listener(Port& port, int type, const pybind11::object& function) {
  auto listener = make_data_listener(function);
  const Released released;
  port.addConnectorDataListener(static_cast<RTC::ConnectorDataListenerType>(type), listener.release());
}

template <class Port>
void add_listener(Port& port, int type, const pybind11::object& function) {
  auto listener = make_listener(function);
  const Released released;
  port.addConnectorListener(static_cast<RTC::ConnectorListenerType>(type), listener.release());
}

template <class Port>
pybind11::list connectors_of(Port& port) {
  RTC::ConnectorInfoList all;
  unlocked([&] { all = port.getConnectorProfiles(); });
  pybind11::list list;
  for (const auto& one : all) list.append(python_info(one));
  return list;
}

}  // namespace python
