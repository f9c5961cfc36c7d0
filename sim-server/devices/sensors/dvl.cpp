#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "devices/ray_world.h"
#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

constexpr int rays_of_rim = 8;

// The cone of a beam in the frame of the sensor: its axis and the rim.
std::vector<Eigen::Vector3d> rays_of(const DvlDef::Beam& beam) {
  const Eigen::AngleAxisd down(M_PI / 2, Eigen::Vector3d::UnitY());
  const auto turned = [](double angle, const Eigen::Vector3d& axis) { return Eigen::AngleAxisd(angle, axis); };
  const Eigen::Quaterniond along = down * turned(beam.rotation, Eigen::Vector3d::UnitX()) * turned(beam.tilt, Eigen::Vector3d::UnitY());
  std::vector<Eigen::Vector3d> rays{along * Eigen::Vector3d::UnitX()};
  for (int i = 0; i < rays_of_rim; ++i) {
    const auto round = turned(2 * M_PI * i / rays_of_rim, Eigen::Vector3d::UnitX());
    rays.push_back(along * (round * (turned(beam.aperture / 2, Eigen::Vector3d::UnitY()) * Eigen::Vector3d::UnitX())));
  }
  return rays;
}

// Doppler velocity log. The echo of a beam is the nearest that its cone meets; the bottom is taken as at rest.
class Dvl final : public Sensor {
 public:
  Dvl(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), mount_(site.mount), def_(std::get<DvlDef>(site.def.data)) {
    std::vector<Eigen::Vector3f> directions;
    for (const auto& beam : def_.beams) {
      const auto rays = rays_of(beam);
      axes_.push_back(rays.front());
      for (const auto& ray : rays) directions.push_back(ray.cast<float>());
    }
    beams_ = Beams(directions, static_cast<float>(def_.range_min), static_cast<float>(def_.range_max));
    world().rays.look_out_of_casing(mount_.link, mount_.pose, beams_);
    for (std::size_t i = 0; i < beams_.size(); ++i) beams_.set_near(i, std::max(beams_.near(i), static_cast<float>(def_.range_min)));
  }

  bool uses_rays() const override { return true; }

 private:
  void add_state_to(StateHash& hash) const override { hash.add(writer().name()); }

  void measure(const Moment&) const override {
    const Eigen::Isometry3d pose = mount_.in_world(physics());
    std::vector<float> ranges(beams_.size());
    world().rays.scene().trace(beams_, pose, ranges, {});
    const Eigen::Vector3d velocity = pose.linear().transpose() * physics().point_velocity(mount_.link, pose.translation());
    auto& out = sample<shm::DvlSample>();
    out.count = static_cast<std::uint32_t>(axes_.size());
    out.locked = 0;
    out.range = std::numeric_limits<double>::infinity();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Vector3d sums = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      const auto first = ranges.begin() + static_cast<std::ptrdiff_t>(i * (rays_of_rim + 1));
      const auto nearest = static_cast<double>(*std::min_element(first, first + rays_of_rim + 1));
      const bool has_echo = std::isfinite(nearest);
      const double speed = has_echo ? noisy(0, velocity.dot(axes_[i])) : 0;
      followers<shm::DvlEcho>(0)[i] = {nearest, speed};
      if (!has_echo) continue;
      const Eigen::Vector3d axis = def_.reference.linear().transpose() * axes_[i];
      squares += axis * axis.transpose();
      sums += speed * axis;
      out.range = std::min(out.range, nearest);
      ++out.locked;
    }
    solve(squares, sums, out);
  }

  // The velocity that fits the speeds along the beams best.
  void solve(const Eigen::Matrix3d& squares, const Eigen::Vector3d& sums, shm::DvlSample& out) const {
    constexpr double flat = 1e-9;  // beams that lie in a plane
    out.has_velocity = out.locked >= 3 && std::abs(squares.determinant()) > flat ? 1 : 0;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> covariance = Eigen::Matrix3d::Zero();
    if (out.has_velocity != 0) {
      const Eigen::Matrix3d inverse = squares.inverse();
      velocity = inverse * sums;
      covariance = std::pow(stated_deviation(def_.speed), 2) * inverse;
    }
    std::memcpy(out.velocity, velocity.data(), sizeof out.velocity);
    std::memcpy(out.covariance, covariance.data(), sizeof out.covariance);
  }

  Mount mount_;
  DvlDef def_;
  std::vector<Eigen::Vector3d> axes_;
  Beams beams_;
};

}  // namespace

MadeDevice make_dvl(const SensorSite& site) {
  const auto& def = std::get<DvlDef>(site.def.data);
  auto info = info_of<shm::DvlInfo>(site);
  info.noise = stated_deviation(def.speed);
  info.min_range = def.range_min;
  info.max_range = def.range_max;
  info.reference = to_pose(def.reference);
  std::vector<shm::DvlBeam> beams;
  for (const auto& beam : def.beams) {
    const Eigen::Vector3d axis = rays_of(beam).front();
    beams.push_back({{axis.x(), axis.y(), axis.z()}, beam.aperture});
  }
  return make_sensor<Dvl>(site, shm::spec_with(shm::IfaceType::dvl, site.iface(), info, std::span<const shm::DvlBeam>(beams)),
                          NoiseChannels::shared(def.speed));
}

}  // namespace sim
