// The common part of device components with one iface: the configuration server_id and device_id, attaching on activation, detaching on
// deactivation, changes of both while running, and the newest sample in onExecute. Ports have the names that the parameter port_names gives
// them when the component is created ("range:ranges,ranger:svc"), so that it can replace a third-party component.
#pragma once

#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

#include <string>

#include "iface_link.h"
#include "line_limit.h"
#include "specification.h"

namespace iface {

class IfaceComponent : public RTC::DataFlowComponentBase {
 public:
  // The specification must live as long.
  IfaceComponent(RTC::Manager* manager, const Specification& specification, shm::IfaceType type, bool subscribe);

  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  // publish() with each new sample.
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onAborting(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onFinalize() override;

 protected:
  // As those of the base, which they hide.
  bool addInPort(const char* name, RTC::InPortBase& port);
  bool addOutPort(const char* name, RTC::OutPortBase& port);
  bool addPort(RTC::PortBase& port);
  // To be called in onInitialize: server_id and device_id, and a parameter of the type's own. Defaults are those of the specification.
  void bindDevice();
  template <class Value>
  void bind(const char* name, Value& value) {
    bindParameter(name, value, specification_.value_of(name));
  }
  // Attaches anew when the configuration names another device. False: it names none that exists; the line is logged.
  bool follow_configuration();
  IfaceLink& link() { return link_; }
  // Called after each attachment, and before the iface is let go.
  virtual void attached(const Device&) {}
  virtual void detaching() {}
  // Tells services what the iface is; called when a simulator was found, also by the link itself after a restart.
  virtual void describe(const shm::Iface&) {}
  // Carries the sample to the ports. Not called for samples that a fault has made invalid.
  virtual void publish(const shm::Iface&) {}
  Say say();
  // For what each call of onActivated or onDeactivated can log: limited, since clients of the wire make such calls, too.
  void say_limited(bool is_problem, const std::string& line);
  // The newest sample, after follow_configuration().
  void publish_newest();

 private:
  std::string port_name(const std::string& own);
  Device configured() const { return {server_id_, device_id_}; }
  bool attach();
  void detach();
  void describe_when_new();

  const Specification& specification_;
  int server_id_ = 0;
  std::string device_id_;
  bool subscribe_;
  IfaceLink link_;
  std::uint64_t described_ = 0;  // of link_.attachments()
  LineLimit limit_;
};

}  // namespace iface
