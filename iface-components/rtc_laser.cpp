#include "rtc_laser.h"

#include <algorithm>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCLaser",
    .description = "Laser scanner of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::laser",
    .parameters = {{"layer", "-1", "int", "spin"}},
};

RTCLaser::RTCLaser(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::laser, true), range_out_("range", range_) {}

RTC::ReturnCode_t RTCLaser::onInitialize() {
  addOutPort("range", range_out_);
  bindDevice();
  bind("layer", layer_);
  return RTC::RTC_OK;
}

RTC::ReturnCode_t RTCLaser::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  auto* laser = link().fresh(iface::wait_limit());
  if (!laser) return RTC::RTC_OK;
  const auto scan = laser->laser_scan();
  if (!scan.sample->stamp.valid) return RTC::RTC_OK;
  const auto& info = laser->info<shm::LaserInfo>();
  const auto layer = layer_ < 0 ? iface::level_layer(info) : std::min(static_cast<std::uint32_t>(layer_), std::max(info.layers, 1u) - 1);
  iface::to_range_data(info, scan, layer, range_);
  range_out_.write();
  return RTC::RTC_OK;
}

extern "C" {
void RTCLaserInit(RTC::Manager* manager) { iface::register_type<RTCLaser>(manager, specification); }
}
