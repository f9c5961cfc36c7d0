// RTCGps: bridges a gps iface to the OutPort `position` (RTC::GPSData; latitude and longitude in degrees, as receivers give them).
// Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCGps : public iface::IfaceComponent {
 public:
  explicit RTCGps(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  RTC::GPSData position_;
  RTC::OutPort<RTC::GPSData> position_out_;
};

extern "C" {
DLL_EXPORT void RTCGpsInit(RTC::Manager* manager);
}
