// RTCGps: bridges a gps iface to the OutPort `position` (RTC::GPSData; latitude and longitude in degrees, as receivers give them).
// Service port `gps` (RTC::GPS). Configuration: server_id, device_id.
#pragma once

#include <rtm/ext/GPSSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataOutPort.h>

#include "geometry_service.h"
#include "iface_component.h"

class RTCGps : public iface::IfaceComponent {
 public:
  explicit RTCGps(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 protected:
  void describe(const shm::Iface& gps) override;

 private:
  RTC::GPSData position_;
  RTC::OutPort<RTC::GPSData> position_out_;
  RTC::CorbaPort service_port_;
  iface::GeometryService<POA_RTC::GPS> service_;
};

extern "C" {
DLL_EXPORT void RTCGpsInit(RTC::Manager* manager);
}
