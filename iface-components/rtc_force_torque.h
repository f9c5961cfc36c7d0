// RTCForceTorque: bridges a force_torque iface to the OutPort `force` (RTC::TimedDoubleSeq: x y z of the force [N], x y z of the torque
// [N m], in the frame that the sensor of the world names; hrpsys' layout). Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCForceTorque : public iface::IfaceComponent {
 public:
  explicit RTCForceTorque(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedDoubleSeq force_;
  RTC::OutPort<RTC::TimedDoubleSeq> force_out_;
};

extern "C" {
DLL_EXPORT void RTCForceTorqueInit(RTC::Manager* manager);
}
