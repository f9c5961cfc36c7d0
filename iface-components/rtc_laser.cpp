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
    : RangerComponent(manager, specification, shm::IfaceType::laser),
      range_out_("range", range_),
      intensities_out_("intensities", intensities_) {}

RTC::ReturnCode_t RTCLaser::onInitialize() {
  addOutPort("range", range_out_);
  addOutPort("intensities", intensities_out_);
  addRangerPort();
  bindDevice();
  bind("layer", layer_);
  return RTC::RTC_OK;
}

void RTCLaser::describe(const shm::Iface& laser) {
  const auto& info = laser.info<shm::LaserInfo>();
  service().describe(iface::ranger_geometry(info), iface::ranger_config(info));
}

void RTCLaser::publish(const shm::Iface& laser) {
  const auto& info = laser.info<shm::LaserInfo>();
  const auto layer = layer_ < 0 ? iface::level_layer(info) : std::min(static_cast<std::uint32_t>(layer_), std::max(info.layers, 1u) - 1);
  const auto wanted = service().wanted();
  iface::to_range_data(info, laser.laser_scan(), layer, range_);
  if (wanted) iface::cut(*wanted, range_);
  range_out_.write();
  if (intensities_out_.connectors().empty() || !service().sends_intensities()) return;
  iface::to_intensity_data(info, laser.laser_scan(), layer, intensities_);
  if (wanted) iface::cut(*wanted, intensities_);
  intensities_out_.write();
}

extern "C" {
void RTCLaserInit(RTC::Manager* manager) { iface::register_type<RTCLaser>(manager, specification); }
}
