#include "devices/laser.h"

#include <algorithm>
#include <cmath>
#include "world/iface_names.h"

namespace sim {

base::Result<std::unique_ptr<Device>> Laser::make(DeviceWorld& world, Mount mount, const SensorDef& sensor) {
  const RayDef& ray = std::get<RayDef>(sensor.data);
  const ModelDef& model = world.physics.def(mount.link.model);
  shm::LaserInfo info{};
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
  info.rate = sensor.update_rate > 0 ? sensor.update_rate : 1 / world.world.physics.step;
  info.noise = ray.noise.kind == NoiseDef::Kind::none ? 0 : ray.noise.stddev;
  info.pose = to_pose(model.links[mount.link.link].pose * mount.pose);
  shm::set_text(info.model, scoped_model(model, sensor.scope));
  auto writer = world.shm.create(shm::laser_spec(iface_name(model, sensor), info));
  if (!writer) return writer.error();
  return std::unique_ptr<Device>(new Laser(world, mount, sensor, std::move(*writer)));
}

Laser::Laser(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::unique_ptr<shm::IfaceWriter> writer)
    : world_(world), mount_(mount), ray_(std::get<RayDef>(sensor.data)), schedule_(sensor.update_rate), writer_(std::move(writer)) {
  const auto far = static_cast<float>(std::isfinite(ray_.range_max) ? ray_.range_max : 1e5);
  beams_ = Beams::fan(std::max(ray_.horizontal.samples, 1), ray_.horizontal.min_angle, ray_.horizontal.max_angle,
                      std::max(ray_.vertical.samples, 1), ray_.vertical.min_angle, ray_.vertical.max_angle, 0, far);
  world_.rays.look_out_of_casing(mount_.link, mount_.pose, beams_);
  noise_ = fresh_noise_ = Noise(ray_.noise, RandomStream(world_.seed, writer_->name()));
}

bool Laser::wants_sample(const Moment& moment) { return schedule_.is_due(moment.time) && writer_->is_subscribed(); }

void Laser::measure(const Moment&) {
  const Eigen::Isometry3d pose = mount_.in_world(world_.physics);
  const auto ranges = writer_->ranges();
  world_.rays.scene().trace(beams_, pose, ranges, writer_->intensities());
  noise_.apply(ranges, static_cast<float>(ray_.range_resolution));
  const auto low = static_cast<float>(ray_.range_min), high = static_cast<float>(ray_.range_max);
  for (float& range : ranges) {
    if (range < low) range = -std::numeric_limits<float>::infinity();
    // Noise may carry a range past the end of the scale; what was hit stays hit.
    if (range > high && range < std::numeric_limits<float>::infinity()) range = high;
  }
  auto& sample = writer_->sample<shm::LaserSample>();
  sample.pose = to_pose(pose);
  sample.count = static_cast<std::uint32_t>(ranges.size());
}

std::vector<Eigen::Vector3d> Laser::look(Eigen::Vector3d& origin) const {
  const Eigen::Isometry3d pose = mount_.in_world(world_.physics);
  origin = pose.translation();
  std::vector<float> ranges(beams_.size());
  world_.rays.scene().trace(beams_, pose, ranges, {});
  std::vector<Eigen::Vector3d> ends;
  const auto count = static_cast<std::size_t>(std::max(ray_.horizontal.samples, 1));
  for (std::size_t i = 0; i < count; ++i) {
    const double range = std::isfinite(ranges[i]) ? static_cast<double>(ranges[i]) : ray_.range_max;
    ends.push_back(pose * (range * beams_.direction(i).cast<double>()));
  }
  return ends;
}

void Laser::publish(const Moment& moment) {
  schedule_.done(moment.time);
  writer_->publish(moment.time);
}

void Laser::show(const Moment& moment) {
  const auto before = noise_;
  Device::show(moment);
  noise_ = before;
}

void Laser::reset() {
  schedule_.restart();
  noise_ = fresh_noise_;
}

void Laser::add_to(StateHash& hash) const {
  hash.add(writer_->name());
  hash.add(noise_.stream().position());
}

}  // namespace sim
