#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

// Height above the start, and climb.
class Altimeter final : public Sensor {
 public:
  Altimeter(Setup setup, const SensorSite& site, double start) : Sensor(std::move(setup)), mount_(site.mount), start_(start) {}

 private:
  void measure(const Moment&) const override {
    const Eigen::Vector3d place = mount_.in_world(physics()).translation();
    auto& out = sample<shm::AltimeterSample>();
    out.height = noisy(0, place.z() - start_);
    out.climb = noisy(1, physics().point_velocity(mount_.link, place).z());
  }

  Mount mount_;
  double start_;  // z in the world [m]
};

}  // namespace

MadeDevice make_altimeter(const SensorSite& site) {
  const auto& def = std::get<AltimeterDef>(site.def.data);
  auto info = info_of<shm::MeterInfo>(site);
  info.noise[0] = stated_deviation(def.vertical_position);
  info.noise[1] = stated_deviation(def.vertical_velocity);
  info.reference = site.mount.in_world(site.world.physics).translation().z();
  return make_sensor<Altimeter>(site, shm::iface_spec(shm::IfaceType::altimeter, site.iface(), info),
                                {def.vertical_position, def.vertical_velocity}, info.reference);
}

}  // namespace sim
