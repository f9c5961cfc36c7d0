// RTCAltimeter: bridges an altimeter iface to the OutPorts `height` (RTC::TimedDouble, m above the start) and `climb` (RTC::TimedDouble,
// m/s upwards). Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCAltimeter : public iface::IfaceComponent {
 public:
  explicit RTCAltimeter(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedDouble height_;
  RTC::OutPort<RTC::TimedDouble> height_out_;
  RTC::TimedDouble climb_;
  RTC::OutPort<RTC::TimedDouble> climb_out_;
};

extern "C" {
DLL_EXPORT void RTCAltimeterInit(RTC::Manager* manager);
}
