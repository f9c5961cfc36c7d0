// RTCLaser: bridges a laser iface to the OutPorts `range` (RTC::RangeData) and `intensities` (RTC::IntensityData, 0 to 1; only when
// connected). Service port `ranger` (RTC::Ranger; see ranger_component.h).
// Configuration: server_id, device_id; layer of a scanner with several (-1: the one nearest to the horizon).
#pragma once

#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include "ranger_component.h"

class RTCLaser : public iface::RangerComponent {
 public:
  explicit RTCLaser(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void describe(const shm::Iface& laser) override;
  void publish(const shm::Iface& laser) override;

 private:
  int layer_ = -1;
  RTC::RangeData range_;
  RTC::OutPort<RTC::RangeData> range_out_;
  RTC::IntensityData intensities_;
  RTC::OutPort<RTC::IntensityData> intensities_out_;
};

extern "C" {
DLL_EXPORT void RTCLaserInit(RTC::Manager* manager);
}
