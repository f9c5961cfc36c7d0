#include "devices/sensors/air_pressure.h"

#include <algorithm>
#include <cmath>

#include "devices/sensors/sensor_makers.h"

namespace sim {

double air_pressure_at(double altitude, double temperature, double pressure) {
  constexpr double lapse = 0.0065, gravity = 9.80665, molar_mass = 0.0289644, gas_constant = 8.31447;
  // The troposphere ends at 11 km; above it and far below the sea the formula would leave its range.
  const double share = 1 - lapse * std::clamp(altitude, -5000.0, 11000.0) / temperature;
  return share > 0 ? pressure * std::pow(share, gravity * molar_mass / (gas_constant * lapse)) : 0;
}

namespace {

class AirPressure final : public Sensor {
 public:
  AirPressure(Setup setup, const SensorSite& site, double origin) : Sensor(std::move(setup)), mount_(site.mount), origin_(origin) {}

 private:
  void measure(const Moment&) const override {
    const double altitude = origin_ + mount_.in_world(physics()).translation().z();
    const PhysicsDef& air = world().world.physics;
    sample<shm::AirPressureSample>().pressure = noisy(0, air_pressure_at(altitude, air.atmosphere_temperature, air.atmosphere_pressure));
  }

  Mount mount_;
  double origin_;  // altitude of the world's origin [m]
};

}  // namespace

MadeDevice make_air_pressure(const SensorSite& site) {
  const auto& def = std::get<AirPressureDef>(site.def.data);
  auto info = info_of<shm::MeterInfo>(site);
  info.noise[0] = stated_deviation(def.pressure);
  info.reference = def.reference_altitude != 0 ? def.reference_altitude : site.world.world.spherical.elevation;
  return make_sensor<AirPressure>(site, shm::iface_spec(shm::IfaceType::air_pressure, site.iface(), info), {def.pressure}, info.reference);
}

}  // namespace sim
