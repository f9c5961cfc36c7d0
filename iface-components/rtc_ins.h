// RTCIns: bridges an ins iface to the OutPort `position` (RTC::INSData; latitude and longitude in degrees, yaw 0 is east). Service port
// `ins` (RTC::INS). Configuration: server_id, device_id.
#pragma once

#include <rtm/ext/INSSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataOutPort.h>

#include "geometry_service.h"
#include "iface_component.h"

class RTCIns : public iface::IfaceComponent {
 public:
  explicit RTCIns(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;
  void describe(const shm::Iface& ins) override;

 private:
  RTC::INSData position_;
  RTC::OutPort<RTC::INSData> position_out_;
  RTC::CorbaPort service_port_;
  iface::GeometryService<POA_RTC::INS> service_;
};

extern "C" {
DLL_EXPORT void RTCInsInit(RTC::Manager* manager);
}
