#include "devices/sensors/laser.h"

#include <algorithm>
#include <cmath>

#include "devices/sensors/sensor_makers.h"

namespace sim {

Laser::Laser(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), mount_(site.mount), ray_(std::get<RayDef>(site.def.data)) {
  const auto far = static_cast<float>(std::isfinite(ray_.range_max) ? ray_.range_max : 1e5);
  beams_ = Beams::fan(std::max(ray_.horizontal.samples, 1), ray_.horizontal.min_angle, ray_.horizontal.max_angle,
                      std::max(ray_.vertical.samples, 1), ray_.vertical.min_angle, ray_.vertical.max_angle, 0, far);
  world().rays.look_out_of_casing(mount_.link, mount_.pose, beams_);
}

void Laser::measure(const Moment&) const {
  const Eigen::Isometry3d pose = mount_.in_world(physics());
  const auto scan = ranges();
  world().rays.scene().trace(beams_, pose, scan, intensities());
  add_noise(scan, static_cast<float>(ray_.range_resolution));
  const auto low = static_cast<float>(ray_.range_min), high = static_cast<float>(ray_.range_max);
  for (float& range : scan) {
    if (range < low) range = -std::numeric_limits<float>::infinity();
    // Noise may carry a range past the end of the scale; what was hit stays hit.
    if (range > high && range < std::numeric_limits<float>::infinity()) range = high;
  }
  auto& out = sample<shm::LaserSample>();
  out.pose = to_pose(pose);
  out.count = static_cast<std::uint32_t>(scan.size());
}

std::vector<Eigen::Vector3d> Laser::look(Eigen::Vector3d& origin) const {
  const Eigen::Isometry3d pose = mount_.in_world(physics());
  origin = pose.translation();
  std::vector<float> ranges(beams_.size());
  world().rays.scene().trace(beams_, pose, ranges, {});
  std::vector<Eigen::Vector3d> ends;
  const auto count = static_cast<std::size_t>(std::max(ray_.horizontal.samples, 1));
  for (std::size_t i = 0; i < count; ++i) {
    const double range = std::isfinite(ranges[i]) ? static_cast<double>(ranges[i]) : ray_.range_max;
    ends.push_back(pose * (range * beams_.direction(i).cast<double>()));
  }
  return ends;
}

MadeDevice make_laser(const SensorSite& site) {
  const RayDef& ray = std::get<RayDef>(site.def.data);
  auto info = info_of<shm::LaserInfo>(site);
  info.beams = static_cast<std::uint32_t>(std::max(ray.horizontal.samples, 1));
  info.layers = static_cast<std::uint32_t>(std::max(ray.vertical.samples, 1));
  info.min_angle = ray.horizontal.min_angle;
  info.max_angle = ray.horizontal.max_angle;
  info.angle_step = info.beams > 1 ? (info.max_angle - info.min_angle) / (info.beams - 1) : 0;
  info.min_vertical = ray.vertical.min_angle;
  info.max_vertical = ray.vertical.max_angle;
  info.min_range = ray.range_min;
  info.max_range = ray.range_max;
  info.range_step = ray.range_resolution;
  info.noise = stated_deviation(ray.noise);
  return make_sensor<Laser>(site, shm::iface_spec(shm::IfaceType::laser, site.iface(), info), NoiseChannels::shared(ray.noise));
}

}  // namespace sim
