#include <cmath>

#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

// Pitot tube along x: the pressure of the air that meets it, against the wind, in the standard atmosphere.
class AirSpeed final : public Sensor {
 public:
  AirSpeed(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), mount_(site.mount) {}

 private:
  void measure(const Moment&) const override {
    constexpr double lapse = 0.0065, density_at_sea = 1.225, exponent = 4.256;  // [K/m], [kg/m^3]
    const Eigen::Isometry3d pose = mount_.in_world(physics());
    const PhysicsDef& air = world().world.physics;
    const Eigen::Vector3d against_air = physics().point_velocity(mount_.link, pose.translation()) - physics().wind();
    const double speed = pose.linear().col(0).dot(against_air);
    const double altitude = world().world.spherical.elevation + pose.translation().z();
    const double temperature = std::max(1.0, air.atmosphere_temperature - lapse * altitude);
    const double density = density_at_sea / std::pow(air.atmosphere_temperature / temperature, exponent);
    auto& out = sample<shm::AirSpeedSample>();
    out.pressure = noisy(0, std::copysign(0.5 * density * speed * speed, speed));
    out.temperature = temperature;
  }

  Mount mount_;
};

}  // namespace

MadeDevice make_air_speed(const SensorSite& site) {
  const auto& def = std::get<AirSpeedDef>(site.def.data);
  auto info = info_of<shm::MeterInfo>(site);
  info.noise[0] = stated_deviation(def.pressure);
  info.reference = site.world.world.spherical.elevation;
  return make_sensor<AirSpeed>(site, shm::iface_spec(shm::IfaceType::air_speed, site.iface(), info), {def.pressure});
}

}  // namespace sim
