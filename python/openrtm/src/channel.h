// A data port whose connections are made in Python: its object takes part in the handshake of a connection and calls functions of Python.
// CSP ports are made of it (packages/OpenRTM_aist/csp.py). Any thread; the functions are called with the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>
#include <rtm/PortBase.h>

#include "listeners.h"

namespace python {

class ChannelPort final : public RTC::PortBase {
 public:
  // publish(profile) -> [(key, text), ...], added to the profile, or None to reject; subscribe(profile) -> bool; unsubscribe(id).
  ChannelPort(const std::string& name, const pybind11::object& publish, const pybind11::object& subscribe,
              const pybind11::object& unsubscribe);
  ~ChannelPort() override { shut(); }

  using PortBase::setConnectionLimit;
  void activateInterfaces() override {}
  void deactivateInterfaces() override {}

 protected:
  RTC::ReturnCode_t publishInterfaces(RTC::ConnectorProfile& profile) override;
  RTC::ReturnCode_t subscribeInterfaces(const RTC::ConnectorProfile& profile) override;
  void unsubscribeInterfaces(const RTC::ConnectorProfile& profile) override;

 private:
  void complain(const char* what, const std::string& problem);

  const Function publish_, subscribe_, unsubscribe_;
};

void add_channels(pybind11::module_& module);

}  // namespace python
