// RTCLaser: bridges a laser iface to the OutPorts `range` (RTC::RangeData) and `intensities` (RTC::IntensityData, 0 to 1; only when
// connected). Service port `ranger` (RTC::Ranger; see ranger_component.h).
// Configuration: server_id, device_id; layer of a scanner with several (-1: the one nearest to the horizon); start_angle, end_angle,
// cluster_count and enable_intensity as RTCHokuyoAIST has them: they count until somebody calls SetConfig or EnableIntensities.
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
  std::optional<RTC::RangerConfig> wanted(const shm::LaserInfo& info) const;

  int layer_ = -1;
  double start_angle_ = 0, end_angle_ = 0;  // [rad]; both 0: all
  int cluster_count_ = 1, enable_intensity_ = 1;
  RTC::RangeData range_;
  RTC::OutPort<RTC::RangeData> range_out_;
  RTC::IntensityData intensities_;
  RTC::OutPort<RTC::IntensityData> intensities_out_;
};

extern "C" {
DLL_EXPORT void RTCLaserInit(RTC::Manager* manager);
}
