// RTCAirPressure: bridges an air_pressure iface to the OutPort `pressure` (RTC::TimedDouble, Pa). Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCAirPressure : public iface::IfaceComponent {
 public:
  explicit RTCAirPressure(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedDouble pressure_;
  RTC::OutPort<RTC::TimedDouble> pressure_out_;
};

extern "C" {
DLL_EXPORT void RTCAirPressureInit(RTC::Manager* manager);
}
