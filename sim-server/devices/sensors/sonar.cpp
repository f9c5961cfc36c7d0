#include "devices/sensors/sonar.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "devices/ray_world.h"

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

class SonarRing final : public Sensor {
 public:
  SonarRing(Setup setup, const std::vector<Transducer>& transducers, const shm::SonarInfo& info)
      : Sensor(std::move(setup)), min_range_(static_cast<float>(info.min_range)), max_range_(static_cast<float>(info.max_range)) {
    for (const auto& t : transducers) {
      mounts_.push_back(t.mount);
      cones_.push_back(cone(half_angle(*t.sensor), max_range_));
      world().rays.look_out_of_casing(t.mount.link, t.mount.pose, cones_.back());
    }
  }
  bool uses_rays() const override { return true; }

 private:
  void measure(const Moment&) const override {
    const auto echoes = ranges();
    for (std::size_t i = 0; i < mounts_.size(); ++i) echoes[i] = nearest(i);
    add_noise(echoes, 0);
    for (float& range : echoes) {
      if (range < min_range_) range = -std::numeric_limits<float>::infinity();
      if (std::isfinite(range)) range = std::min(range, max_range_);
    }
    sample<shm::SonarSample>().count = static_cast<std::uint32_t>(echoes.size());
  }

  float nearest(std::size_t transducer) const {
    const Eigen::Isometry3d pose = mounts_[transducer].in_world(physics());
    const Beams& cone = cones_[transducer];
    float range = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < cone.size(); ++k) {
      const Eigen::Vector3d direction = pose.linear() * cone.direction(k).cast<double>();
      const RayHit hit = world().rays.scene().trace_one(pose.translation(), direction, cone.near(k), max_range_);
      // Sound that meets a surface at a grazing angle, such as the floor, does not come back.
      if (std::isfinite(hit.range) && std::abs(hit.normal.cast<double>().dot(direction)) > grazing) range = std::min(range, hit.range);
    }
    return range;
  }

  std::vector<Mount> mounts_;
  std::vector<Beams> cones_;
  float min_range_, max_range_;
};

}  // namespace

MadeDevice make_sonar_ring(DeviceWorld& world, const std::string& name, const std::string& scope,
                           const std::vector<Transducer>& transducers) {
  const SensorDef& first = *transducers.front().sensor;
  const auto* ray = std::get_if<RayDef>(&first.data);
  const ModelId id = transducers.front().mount.link.model;
  const ModelDef& model = world.physics.def(id);
  shm::SonarInfo info{};
  info.min_range = range_min(first);
  info.max_range = range_max(first);
  info.cone = 2 * half_angle(first);
  info.rate = stated_rate(world, first.update_rate);
  if (ray != nullptr) info.noise = stated_deviation(ray->noise);
  info.pose = shm::identity_pose;
  shm::set_text(info.model, scoped_model(model, scope));
  std::vector<shm::Pose> poses;
  for (const auto& t : transducers) poses.push_back(pose_on_model(model, t.mount));
  auto setup = set_up(world, id, first.update_rate, shm::sonar_spec(name, info, poses),
                      NoiseChannels::shared(ray != nullptr ? ray->noise : NoiseDef{}));
  if (!setup) return setup.error();
  return MadeDevice(std::make_unique<SonarRing>(std::move(*setup), transducers, info));
}

}  // namespace sim
