#include "rtc_laser.h"

#include <algorithm>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCLaser",
    .description = "Laser scanner of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::laser",
    .parameters = {{"layer", "-1", "int", "spin"},
                   {"start_angle", "0", "double", "text"},
                   {"end_angle", "0", "double", "text"},
                   {"cluster_count", "1", "int", "spin", "1<=x<=1000"},
                   {"enable_intensity", "1", "int", "radio", "(0,1)"}},
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
  bind("start_angle", start_angle_);
  bind("end_angle", end_angle_);
  bind("cluster_count", cluster_count_);
  bind("enable_intensity", enable_intensity_);
  return RTC::RTC_OK;
}

void RTCLaser::describe(const shm::Iface& laser) {
  const auto& info = laser.info<shm::LaserInfo>();
  service().describe(iface::ranger_geometry(info), iface::ranger_config(info));
}

std::optional<RTC::RangerConfig> RTCLaser::wanted(const shm::LaserInfo& info) const {
  if (const auto asked = service().wanted()) return asked;
  if (start_angle_ == 0 && end_angle_ == 0 && cluster_count_ <= 1) return std::nullopt;
  const RTC::RangerConfig sensor = iface::ranger_config(info);
  RTC::RangerConfig config = sensor;
  config.minAngle = start_angle_;
  config.maxAngle = end_angle_;
  config.angularRes = cluster_count_ * sensor.angularRes;
  return iface::possible(sensor, config);
}

void RTCLaser::publish(const shm::Iface& laser) {
  const auto& info = laser.info<shm::LaserInfo>();
  const auto layer = layer_ < 0 ? iface::level_layer(info) : std::min(static_cast<std::uint32_t>(layer_), std::max(info.layers, 1u) - 1);
  const auto wanted = this->wanted(info);
  iface::to_range_data(info, laser.laser_scan(), layer, range_);
  if (wanted) iface::cut(*wanted, range_);
  range_out_.write();
  if (intensities_out_.connectors().empty() || enable_intensity_ == 0 || !service().sends_intensities()) return;
  iface::to_intensity_data(info, laser.laser_scan(), layer, intensities_);
  if (wanted) iface::cut(*wanted, intensities_);
  intensities_out_.write();
}

extern "C" {
void RTCLaserInit(RTC::Manager* manager) { iface::register_type<RTCLaser>(manager, specification); }
}
