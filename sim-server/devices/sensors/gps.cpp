#include "devices/sensors/gps.h"

#include <cmath>
#include <numbers>

#include "devices/sensors/sensor_makers.h"

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

namespace {

class Gps final : public Sensor {
 public:
  Gps(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), mount_(site.mount) {}

 private:
  enum Channel { across, up, velocity_across, velocity_up };

  void measure(const Moment&) const override {
    const SphericalDef& earth = world().world.spherical;
    const Eigen::Vector3d p = mount_.in_world(physics()).translation();
    const Eigen::AngleAxisd to_east(earth.heading, Eigen::Vector3d::UnitZ());
    Eigen::Vector3d enu = to_east * p, velocity = to_east * physics().point_velocity(mount_.link, p);
    for (int i = 0; i < 3; ++i) {
      enu[i] = noisy(i < 2 ? across : up, enu[i]);
      velocity[i] = noisy(i < 2 ? velocity_across : velocity_up, velocity[i]);
    }
    const Eigen::Vector3d geodetic = geodetic_of(earth, enu);
    auto& out = sample<shm::GpsSample>();
    out.latitude = geodetic[0];
    out.longitude = geodetic[1];
    out.altitude = geodetic[2];
    for (int i = 0; i < 3; ++i) out.velocity[i] = velocity[i];
  }

  Mount mount_;
};

}  // namespace

MadeDevice make_gps(const SensorSite& site) {
  const auto& def = std::get<GpsDef>(site.def.data);
  const SphericalDef& earth = site.world.world.spherical;
  auto info = info_of<shm::GpsInfo>(site);
  info.position_noise = stated_deviation(def.horizontal_position);
  info.altitude_noise = stated_deviation(def.vertical_position);
  info.velocity_noise = stated_deviation(def.horizontal_velocity);
  info.latitude = earth.latitude;
  info.longitude = earth.longitude;
  info.altitude = earth.elevation;
  info.heading = earth.heading;
  return make_sensor<Gps>(site, shm::iface_spec(shm::IfaceType::gps, site.iface(), info),
                          {def.horizontal_position, def.vertical_position, def.horizontal_velocity, def.vertical_velocity});
}

}  // namespace sim
