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
  if (ray_.is_rolling) split();
  sweep_ = std::chrono::nanoseconds(ray_.is_rolling ? std::llround(1e9 / stated_rate(site.world, site.def.update_rate)) : 0);
}

// Columns within four degrees are seen from one place: a millimetre apart at 1 m/s and ten turns a second.
void Laser::split() {
  constexpr std::size_t max_sectors = 90;
  const auto columns = static_cast<std::size_t>(std::max(ray_.horizontal.samples, 1));
  const std::size_t layers = beams_.size() / columns, sectors = std::min(columns, max_sectors);
  for (std::size_t s = 0; s < sectors; ++s) {
    Sector sector{s * columns / sectors, 0, {}};
    sector.count = (s + 1) * columns / sectors - sector.first;
    std::vector<Eigen::Vector3f> directions;
    for (std::size_t layer = 0; layer < layers; ++layer) {
      for (std::size_t i = 0; i < sector.count; ++i) directions.push_back(beams_.direction(layer * columns + sector.first + i));
    }
    sector.beams = Beams(directions, 0, beams_.far());
    for (std::size_t i = 0; i < directions.size(); ++i)
      sector.beams.set_near(i, beams_.near(i / sector.count * columns + sector.first + i % sector.count));
    sectors_.push_back(std::move(sector));
  }
}

void Laser::after_step(const Moment& moment) {
  places_.push_back({moment.time, mount_.in_world(physics())});
  while (places_.size() > 1 && places_[1].time <= moment.time - sweep_) places_.pop_front();
}

Eigen::Isometry3d Laser::place_at(std::chrono::nanoseconds time) const {
  const auto after = std::find_if(places_.begin(), places_.end(), [&](const Place& place) { return place.time >= time; });
  if (places_.empty() || after == places_.end()) return mount_.in_world(physics());
  if (after == places_.begin()) return after->pose;
  const Place &a = *(after - 1), &b = *after;
  const double share = static_cast<double>((time - a.time).count()) / static_cast<double>((b.time - a.time).count());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(a.pose.linear()).slerp(share, Eigen::Quaterniond(b.pose.linear())).toRotationMatrix();
  pose.translation() = (1 - share) * a.pose.translation() + share * b.pose.translation();
  return pose;
}

// Only the scanner moves during a turn: everything else is where it is at its end.
void Laser::trace_rolling(const Moment& moment) const {
  const auto columns = static_cast<std::size_t>(std::max(ray_.horizontal.samples, 1));
  const double last = std::max<double>(1, static_cast<double>(columns - 1));
  const auto scan = ranges(), retros = intensities();
  std::vector<float> part, part_retros;
  for (const Sector& sector : sectors_) {
    const double share = (static_cast<double>(sector.first) + 0.5 * static_cast<double>(sector.count - 1)) / last;
    const auto time = moment.time - sweep_ + std::chrono::nanoseconds(std::llround(share * static_cast<double>(sweep_.count())));
    part.resize(sector.beams.size());
    part_retros.resize(sector.beams.size());
    world().rays.scene().trace(sector.beams, place_at(time), part, part_retros);
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::size_t beam = i / sector.count * columns + sector.first + i % sector.count;
      scan[beam] = part[i];
      retros[beam] = part_retros[i];
    }
  }
}

void Laser::measure(const Moment& moment) const {
  const Eigen::Isometry3d pose = mount_.in_world(physics());
  const auto scan = ranges();
  if (ray_.is_rolling) {
    trace_rolling(moment);
  } else {
    world().rays.scene().trace(beams_, pose, scan, intensities());
  }
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
  out.sweep_ns = static_cast<std::uint32_t>(sweep_.count());
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
