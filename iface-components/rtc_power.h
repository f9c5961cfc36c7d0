// RTCPower: bridges a battery iface to the OutPorts `voltage` (RTC::TimedDouble, V), `current` (RTC::TimedDouble, A out of the battery),
// `level` (RTC::TimedDouble, 0 to 1) and `state` (RTC::TimedLong, RTMSIM_BATTERY_*). The newest value of the InPort `charger`
// (RTC::TimedBoolean) connects the charger; it is disconnected when the component is deactivated. Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCPower : public iface::IfaceComponent {
 public:
  explicit RTCPower(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedBoolean charger_;
  RTC::InPort<RTC::TimedBoolean> charger_in_;
  RTC::TimedDouble voltage_;
  RTC::OutPort<RTC::TimedDouble> voltage_out_;
  RTC::TimedDouble current_;
  RTC::OutPort<RTC::TimedDouble> current_out_;
  RTC::TimedDouble level_;
  RTC::OutPort<RTC::TimedDouble> level_out_;
  RTC::TimedLong state_;
  RTC::OutPort<RTC::TimedLong> state_out_;
};

extern "C" {
DLL_EXPORT void RTCPowerInit(RTC::Manager* manager);
}
