#include <cmath>

#include "devices/sensors/gps.h"
#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

// Inertial navigation: what a gps and an imu of one place say together. Yaw 0 is east.
class Ins final : public Sensor {
 public:
  Ins(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), mount_(site.mount) {}

 private:
  enum Channel { east, north, up, velocity_east, velocity_north, velocity_up, roll, pitch, yaw };

  void measure(const Moment&) const override {
    const SphericalDef& earth = world().world.spherical;
    const Eigen::AngleAxisd to_east(earth.heading, Eigen::Vector3d::UnitZ());
    const Eigen::Isometry3d pose = mount_.in_world(physics());
    Eigen::Vector3d enu = to_east * pose.translation();
    const Eigen::Vector3d velocity = to_east * physics().point_velocity(mount_.link, pose.translation());
    for (int i = 0; i < 3; ++i) enu[i] = noisy(static_cast<std::size_t>(east + i), enu[i]);
    const Eigen::Vector3d geodetic = geodetic_of(earth, enu);
    const Eigen::Matrix3d turn = to_east.toRotationMatrix() * pose.linear();
    auto& out = sample<shm::InsSample>();
    out.latitude = geodetic[0], out.longitude = geodetic[1], out.altitude = geodetic[2];
    out.height = enu.z();
    for (int i = 0; i < 3; ++i) out.velocity[i] = noisy(static_cast<std::size_t>(velocity_east + i), velocity[i]);
    out.orientation[0] = noisy(roll, std::atan2(turn(2, 1), turn(2, 2)));
    out.orientation[1] = noisy(pitch, std::asin(std::clamp(-turn(2, 0), -1.0, 1.0)));
    out.orientation[2] = std::remainder(noisy(yaw, std::atan2(turn(1, 0), turn(0, 0))), 2 * M_PI);
  }

  Mount mount_;
};

}  // namespace

MadeDevice make_ins(const SensorSite& site) {
  const auto& def = std::get<InsDef>(site.def.data);
  auto info = info_of<shm::InsInfo>(site);
  info.position_noise = stated_deviation(def.horizontal_position);
  info.altitude_noise = stated_deviation(def.vertical_position);
  info.velocity_noise = stated_deviation(def.horizontal_velocity);
  info.heading_noise = stated_deviation(def.heading);
  return make_sensor<Ins>(site, shm::iface_spec(shm::IfaceType::ins, site.iface(), info),
                          {def.horizontal_position, def.horizontal_position, def.vertical_position, def.horizontal_velocity,
                           def.horizontal_velocity, def.vertical_velocity, def.attitude, def.attitude, def.heading});
}

}  // namespace sim
