// RTCWireless: bridges a wireless iface to the OutPorts `essids` (RTC::TimedStringSeq: transmitters that are received, the strongest first)
// and `levels` (RTC::TimedDoubleSeq, dBm, in the same order). Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCWireless : public iface::IfaceComponent {
 public:
  explicit RTCWireless(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedStringSeq essids_;
  RTC::OutPort<RTC::TimedStringSeq> essids_out_;
  RTC::TimedDoubleSeq levels_;
  RTC::OutPort<RTC::TimedDoubleSeq> levels_out_;
};

extern "C" {
DLL_EXPORT void RTCWirelessInit(RTC::Manager* manager);
}
