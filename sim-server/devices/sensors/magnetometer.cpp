#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

// The earth's field in the sensor's frame.
class Magnetometer final : public Sensor {
 public:
  Magnetometer(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), mount_(site.mount) {}

 private:
  void measure(const Moment&) const override {
    const Eigen::Vector3d field = mount_.in_world(physics()).linear().transpose() * world().world.physics.magnetic_field;
    auto& out = sample<shm::MagnetometerSample>();
    for (std::size_t i = 0; i < 3; ++i) out.field[i] = noisy(i, field[static_cast<Eigen::Index>(i)]);
  }

  Mount mount_;
};

}  // namespace

MadeDevice make_magnetometer(const SensorSite& site) {
  const auto& noises = std::get<MagnetometerDef>(site.def.data).field;
  auto info = info_of<shm::MeterInfo>(site);
  info.noise[0] = stated_deviation(noises[0]);
  return make_sensor<Magnetometer>(site, shm::iface_spec(shm::IfaceType::magnetometer, site.iface(), info),
                                   std::vector<NoiseDef>(noises.begin(), noises.end()));
}

}  // namespace sim
