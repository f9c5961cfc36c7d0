// RTCWheels: bridges a wheels iface to the OutPorts `angles` (RTC::TimedDoubleSeq, rad: what the ticks stand for), `speeds`
// (RTC::TimedDoubleSeq, rad/s) and `ticks` (RTC::TimedLongSeq, since the start), each in the order of the wheels. Configuration:
// server_id, device_id.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCWheels : public iface::IfaceComponent {
 public:
  explicit RTCWheels(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedDoubleSeq angles_;
  RTC::OutPort<RTC::TimedDoubleSeq> angles_out_;
  RTC::TimedDoubleSeq speeds_;
  RTC::OutPort<RTC::TimedDoubleSeq> speeds_out_;
  RTC::TimedLongSeq ticks_;
  RTC::OutPort<RTC::TimedLongSeq> ticks_out_;
};

extern "C" {
DLL_EXPORT void RTCWheelsInit(RTC::Manager* manager);
}
