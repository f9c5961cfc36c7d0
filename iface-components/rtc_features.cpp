#include "rtc_features.h"

#include <cmath>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCFeatures",
    .description = "Lines and corners in the scans of a simulated laser scanner",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::laser",
    .parameters = {{"distance", "0.05", "double", "text", "x>0"},
                   {"gap", "0.3", "double", "text", "x>0"},
                   {"points", "8", "int", "spin", "3<=x<=1000"}},
};

RTCFeatures::RTCFeatures(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::laser, true), features_out_("features", features_) {}

RTC::ReturnCode_t RTCFeatures::onInitialize() {
  addOutPort("features", features_out_);
  bindDevice();
  bind("distance", limits_.distance);
  bind("gap", limits_.gap);
  bind("points", limits_.points);
  return RTC::RTC_OK;
}

// Of several layers the most level one.
void RTCFeatures::publish(const shm::Iface& device) {
  const auto& info = device.info<shm::LaserInfo>();
  const auto scan = device.laser_scan();
  const auto ranges = scan.ranges.subspan(std::size_t{iface::level_layer(info)} * info.beams, info.beams);
  limits_.noise = std::max(info.noise, 1e-4);
  points_.resize(ranges.size());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle = info.min_angle + static_cast<double>(i) * info.angle_step, range = static_cast<double>(ranges[i]);
    const bool is_hit = std::isfinite(range) && range < info.max_range;
    points_[i] = is_hit ? iface::ScanPoint{range * std::cos(angle), range * std::sin(angle), true} : iface::ScanPoint{};
  }
  features_.tm = iface::to_time(scan.sample->stamp.sim_time_ns);
  iface::find_features(points_, limits_, features_);
  features_out_.write();
}

extern "C" {
void RTCFeaturesInit(RTC::Manager* manager) { iface::register_type<RTCFeatures>(manager, specification); }
}
