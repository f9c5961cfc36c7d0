#include <cmath>
#include <numbers>

#include "devices/simple_devices.h"
#include "world/iface_names.h"

namespace sim {
namespace {

constexpr double equator = 6378137.0, flattening = 1 / 298.257223563;
constexpr double e2 = flattening * (2 - flattening);
constexpr double degree = std::numbers::pi / 180;

Eigen::Vector3d earth_centred(double latitude, double longitude, double altitude) {
  const double n = equator / std::sqrt(1 - e2 * std::sin(latitude) * std::sin(latitude));
  return {(n + altitude) * std::cos(latitude) * std::cos(longitude), (n + altitude) * std::cos(latitude) * std::sin(longitude),
          (n * (1 - e2) + altitude) * std::sin(latitude)};
}

}  // namespace

Eigen::Vector3d geodetic_of(const SphericalDef& place, const Eigen::Vector3d& enu) {
  const double lat = place.latitude * degree, lon = place.longitude * degree;
  Eigen::Matrix3d axes;                                                                   // columns: east, north, up
  axes << -std::sin(lon), -std::sin(lat) * std::cos(lon), std::cos(lat) * std::cos(lon),  //
      std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat) * std::sin(lon),       //
      0, std::cos(lat), std::sin(lat);
  const Eigen::Vector3d p = earth_centred(lat, lon, place.elevation) + axes * enu;
  const double across = p.head<2>().norm();
  double latitude = std::atan2(p.z(), across * (1 - e2)), altitude = 0;
  for (int i = 0; i < 6; ++i) {
    const double n = equator / std::sqrt(1 - e2 * std::sin(latitude) * std::sin(latitude));
    altitude = across > 1 ? across / std::cos(latitude) - n : std::abs(p.z()) - n * (1 - e2);
    latitude = std::atan2(p.z(), across * (1 - e2 * n / (n + altitude)));
  }
  return {latitude / degree, std::atan2(p.y(), p.x()) / degree, altitude};
}

base::Result<std::unique_ptr<Device>> Gps::make(DeviceWorld& world, Mount mount, const SensorDef& sensor) {
  const ModelDef& model = world.physics.def(mount.link.model);
  const auto& def = std::get<GpsDef>(sensor.data);
  const auto deviation = [](const NoiseDef& noise) { return noise.kind == NoiseDef::Kind::none ? 0 : noise.stddev; };
  shm::GpsInfo info{};
  info.rate = sensor.update_rate > 0 ? sensor.update_rate : 1 / world.world.physics.step;
  info.position_noise = deviation(def.horizontal_position);
  info.altitude_noise = deviation(def.vertical_position);
  info.velocity_noise = deviation(def.horizontal_velocity);
  info.latitude = world.world.spherical.latitude;
  info.longitude = world.world.spherical.longitude;
  info.altitude = world.world.spherical.elevation;
  info.heading = world.world.spherical.heading;
  info.pose = to_pose(model.links[mount.link.link].pose * mount.pose);
  shm::set_text(info.model, scoped_model(model, sensor.scope));
  auto writer = world.shm.create(shm::gps_spec(iface_name(model, sensor), info));
  if (!writer) return writer.error();
  return std::unique_ptr<Device>(new Gps(world, mount, sensor, std::move(*writer)));
}

Gps::Gps(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::unique_ptr<shm::IfaceWriter> writer)
    : world_(world), mount_(mount), schedule_(sensor.update_rate), writer_(std::move(writer)) {
  const auto& def = std::get<GpsDef>(sensor.data);
  const NoiseDef* noises[4] = {&def.horizontal_position, &def.vertical_position, &def.horizontal_velocity, &def.vertical_velocity};
  for (std::size_t i = 0; i < 4; ++i) noise_[i] = Noise(*noises[i], RandomStream(world.seed, writer_->name() + static_cast<char>('a' + i)));
  fresh_noise_ = noise_;
}

void Gps::measure(const Moment&) {
  const Eigen::Vector3d p = mount_.in_world(world_.physics).translation();
  const Eigen::AngleAxisd to_east(world_.world.spherical.heading, Eigen::Vector3d::UnitZ());
  Eigen::Vector3d enu = to_east * p, velocity = to_east * world_.physics.point_velocity(mount_.link, p);
  const double dt = std::max(static_cast<double>(schedule_.period().count()) * 1e-9, world_.world.physics.step);
  for (int i = 0; i < 3; ++i) {
    enu[i] = noise_[i < 2 ? 0 : 1].apply(enu[i], dt);
    velocity[i] = noise_[i < 2 ? 2 : 3].apply(velocity[i], dt);
  }
  const Eigen::Vector3d geodetic = geodetic_of(world_.world.spherical, enu);
  auto& sample = writer_->sample<shm::GpsSample>();
  sample.latitude = geodetic[0];
  sample.longitude = geodetic[1];
  sample.altitude = geodetic[2];
  for (int i = 0; i < 3; ++i) sample.velocity[i] = velocity[i];
}

void Gps::publish(const Moment& moment) {
  schedule_.done(moment.time);
  writer_->publish(moment.time);
}

void Gps::show(const Moment& moment) {
  const auto before = noise_;
  Device::show(moment);
  noise_ = before;
}

void Gps::reset() {
  schedule_.restart();
  noise_ = fresh_noise_;
}

void Gps::add_to(StateHash& hash) const {
  for (const auto& noise : noise_) hash.add(noise.stream().position());
}

}  // namespace sim
