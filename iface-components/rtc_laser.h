// RTCLaser: bridges a laser iface to the OutPort `range` (RTC::RangeData).
// Configuration: server_id, device_id; layer of a scanner with several (-1: the one nearest to the horizon).
#pragma once

#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCLaser : public iface::IfaceComponent {
 public:
  explicit RTCLaser(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  int layer_ = -1;
  RTC::RangeData range_;
  RTC::OutPort<RTC::RangeData> range_out_;
};

extern "C" {
DLL_EXPORT void RTCLaserInit(RTC::Manager* manager);
}
