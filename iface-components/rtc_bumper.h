// RTCBumper: bridges a bumper iface to the OutPorts `contact` (RTC::TimedBooleanSeq of one: touched) and `force` (RTC::TimedDoubleSeq: x y
// z [N] of each contact, world frame). The standard types have geometries of bumpers, but no data. Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCBumper : public iface::IfaceComponent {
 public:
  explicit RTCBumper(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& bumper) override;

 private:
  RTC::TimedBooleanSeq contact_;
  RTC::OutPort<RTC::TimedBooleanSeq> contact_out_;
  RTC::TimedDoubleSeq force_;
  RTC::OutPort<RTC::TimedDoubleSeq> force_out_;
};

extern "C" {
DLL_EXPORT void RTCBumperInit(RTC::Manager* manager);
}
