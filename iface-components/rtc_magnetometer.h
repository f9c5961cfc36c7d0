// RTCMagnetometer: bridges a magnetometer iface to the OutPort `field` (RTC::TimedVector3D: the earth's field in the sensor frame, T).
// Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/ExtendedDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCMagnetometer : public iface::IfaceComponent {
 public:
  explicit RTCMagnetometer(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedVector3D field_;
  RTC::OutPort<RTC::TimedVector3D> field_out_;
};

extern "C" {
DLL_EXPORT void RTCMagnetometerInit(RTC::Manager* manager);
}
