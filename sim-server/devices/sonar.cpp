#include <algorithm>
#include <cmath>
#include <numbers>

#include "devices/simple_devices.h"

namespace sim {
namespace {

constexpr double grazing = 0.26;  // sine of 15 degrees

// Half the opening of the cone, whether it is written as a sonar or as a ray sensor with a narrow fan.
double half_angle(const SensorDef& sensor) {
  if (const auto* sonar = std::get_if<SonarDef>(&sensor.data)) return std::atan2(sonar->radius, sonar->range_max);
  const auto& ray = std::get<RayDef>(sensor.data);
  return std::clamp((ray.horizontal.max_angle - ray.horizontal.min_angle) / 2, 0.0, 1.5);
}

double range_min(const SensorDef& sensor) {
  const auto* sonar = std::get_if<SonarDef>(&sensor.data);
  return sonar != nullptr ? sonar->range_min : std::get<RayDef>(sensor.data).range_min;
}
double range_max(const SensorDef& sensor) {
  const auto* sonar = std::get_if<SonarDef>(&sensor.data);
  return sonar != nullptr ? sonar->range_max : std::get<RayDef>(sensor.data).range_max;
}

// The middle and three circles: 32 rays, two packets.
Beams cone(double half, float far) {
  std::vector<Eigen::Vector3f> directions{Eigen::Vector3f::UnitX()};
  for (const auto& [share, count] : {std::pair{0.35, 7}, {0.7, 11}, {1.0, 13}}) {
    for (int i = 0; i < count; ++i) {
      const double around = 2 * std::numbers::pi * i / count, off = share * half;
      directions.emplace_back(static_cast<float>(std::cos(off)), static_cast<float>(std::sin(off) * std::cos(around)),
                              static_cast<float>(std::sin(off) * std::sin(around)));
    }
  }
  return Beams(directions, 0, far);
}

}  // namespace

base::Result<std::unique_ptr<Device>> SonarRing::make(DeviceWorld& world, const std::string& name, const std::string& scope,
                                                      const std::vector<Transducer>& transducers) {
  const SensorDef& first = *transducers.front().sensor;
  const ModelDef& model = world.physics.def(transducers.front().mount.link.model);
  shm::SonarInfo info{};
  info.min_range = range_min(first);
  info.max_range = range_max(first);
  info.cone = 2 * half_angle(first);
  info.rate = first.update_rate > 0 ? first.update_rate : 1 / world.world.physics.step;
  if (const auto* ray = std::get_if<RayDef>(&first.data)) info.noise = ray->noise.kind == NoiseDef::Kind::none ? 0 : ray->noise.stddev;
  info.pose = shm::identity_pose;
  shm::set_text(info.model, scoped_model(model, scope));
  std::vector<shm::Pose> poses;
  for (const auto& t : transducers) poses.push_back(to_pose(model.links[t.mount.link.link].pose * t.mount.pose));
  auto writer = world.shm.create(shm::sonar_spec(name, info, poses));
  if (!writer) return writer.error();
  return std::unique_ptr<Device>(new SonarRing(world, transducers, info, std::move(*writer)));
}

SonarRing::SonarRing(DeviceWorld& world, const std::vector<Transducer>& transducers, const shm::SonarInfo& info,
                     std::unique_ptr<shm::IfaceWriter> writer)
    : world_(world),
      min_range_(static_cast<float>(info.min_range)),
      max_range_(static_cast<float>(info.max_range)),
      schedule_(transducers.front().sensor->update_rate),
      writer_(std::move(writer)) {
  for (const auto& t : transducers) {
    mounts_.push_back(t.mount);
    cones_.push_back(cone(half_angle(*t.sensor), max_range_));
    world_.rays.look_out_of_casing(t.mount.link, t.mount.pose, cones_.back());
  }
  if (const auto* ray = std::get_if<RayDef>(&transducers.front().sensor->data)) {
    noise_ = fresh_noise_ = Noise(ray->noise, RandomStream(world.seed, writer_->name()));
  }
}

void SonarRing::measure(const Moment&) {
  const auto ranges = writer_->ranges();
  for (std::size_t i = 0; i < mounts_.size(); ++i) {
    const Eigen::Isometry3d pose = mounts_[i].in_world(world_.physics);
    ranges[i] = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < cones_[i].size(); ++k) {
      const Eigen::Vector3d direction = pose.linear() * cones_[i].direction(k).cast<double>();
      const RayHit hit = world_.rays.scene().trace_one(pose.translation(), direction, cones_[i].near(k), max_range_);
      // Sound that meets a surface at a grazing angle, such as the floor, does not come back.
      if (std::isfinite(hit.range) && std::abs(hit.normal.cast<double>().dot(direction)) > grazing)
        ranges[i] = std::min(ranges[i], hit.range);
    }
  }
  noise_.apply(ranges, 0);
  for (float& range : ranges) {
    if (range < min_range_) range = -std::numeric_limits<float>::infinity();
    if (std::isfinite(range)) range = std::min(range, max_range_);
  }
  writer_->sample<shm::SonarSample>().count = static_cast<std::uint32_t>(ranges.size());
}

void SonarRing::publish(const Moment& moment) {
  schedule_.done(moment.time);
  writer_->publish(moment.time);
}

void SonarRing::show(const Moment& moment) {
  const auto before = noise_;
  Device::show(moment);
  noise_ = before;
}

void SonarRing::reset() {
  schedule_.restart();
  noise_ = fresh_noise_;
}

void SonarRing::add_to(StateHash& hash) const { hash.add(noise_.stream().position()); }

}  // namespace sim
