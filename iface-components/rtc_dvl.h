// RTCDvl: bridges a dvl iface to the OutPorts `velocity` (RTC::TimedVelocity3D: vx vy vz [m/s] in the reference frame of the sensor; only
// while at least three beams have an echo), `range` (RTC::TimedDouble, m: the nearest echo) and `ranges` (RTC::TimedDoubleSeq, m: one for
// each beam). Without an echo a range is the maximum range. Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCDvl : public iface::IfaceComponent {
 public:
  explicit RTCDvl(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedVelocity3D velocity_;
  RTC::OutPort<RTC::TimedVelocity3D> velocity_out_;
  RTC::TimedDouble range_;
  RTC::OutPort<RTC::TimedDouble> range_out_;
  RTC::TimedDoubleSeq ranges_;
  RTC::OutPort<RTC::TimedDoubleSeq> ranges_out_;
};

extern "C" {
DLL_EXPORT void RTCDvlInit(RTC::Manager* manager);
}
