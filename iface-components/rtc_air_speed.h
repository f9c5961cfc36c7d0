// RTCAirSpeed: bridges an air_speed iface to the OutPorts `pressure` (RTC::TimedDouble, Pa: dynamic pressure of the air ahead, negative
// from behind) and `temperature` (RTC::TimedDouble, K). Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCAirSpeed : public iface::IfaceComponent {
 public:
  explicit RTCAirSpeed(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedDouble pressure_;
  RTC::OutPort<RTC::TimedDouble> pressure_out_;
  RTC::TimedDouble temperature_;
  RTC::OutPort<RTC::TimedDouble> temperature_out_;
};

extern "C" {
DLL_EXPORT void RTCAirSpeedInit(RTC::Manager* manager);
}
