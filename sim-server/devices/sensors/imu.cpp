#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

Eigen::Matrix3d reference_axes(const ImuDef& def, double heading) {
  using Reference = ImuDef::Reference;
  if (def.reference == Reference::world) return Eigen::Matrix3d::Identity();
  if (def.reference == Reference::custom) return def.custom_axes;
  // Columns: east, north, up in the world, whose x axis points `heading` to the left of east.
  const Eigen::Matrix3d enu = Eigen::AngleAxisd(-heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Eigen::Matrix3d axes = enu;
  if (def.reference == Reference::ned) axes << enu.col(1), enu.col(0), -enu.col(2);
  if (def.reference == Reference::nwu) axes << enu.col(1), -enu.col(0), enu.col(2);
  return axes;
}

class Imu final : public Sensor {
 public:
  Imu(Setup setup, const SensorSite& site) : Sensor(std::move(setup)), mount_(site.mount) {
    const auto& def = std::get<ImuDef>(site.def.data);
    has_orientation_ = def.has_orientation;
    reference_ = reference_axes(def, site.world.world.spherical.heading);
  }

  bool follows_steps() const override { return true; }
  void after_step(const Moment& moment) override {
    // Always, so that the first sample of who comes later is right as well.
    const Eigen::Vector3d velocity = physics().point_velocity(mount_.link, mount_.in_world(physics()).translation());
    acceleration_ = has_velocity_ ? ((velocity - velocity_) / moment.dt).eval() : Eigen::Vector3d::Zero();
    velocity_ = velocity;
    has_velocity_ = true;
  }

 private:
  void measure(const Moment&) const override {
    const Eigen::Isometry3d pose = mount_.in_world(physics());
    const Eigen::Matrix3d to_sensor = pose.linear().transpose();
    const Eigen::Vector3d w = to_sensor * physics().link_twist(mount_.link).angular;
    const Eigen::Vector3d f = to_sensor * (acceleration_ - world().world.physics.gravity);
    auto& out = sample<shm::ImuSample>();
    const Eigen::Quaterniond q =
        has_orientation_ ? Eigen::Quaterniond(reference_.transpose() * pose.linear()) : Eigen::Quaterniond::Identity();
    out.orientation[0] = q.w(), out.orientation[1] = q.x(), out.orientation[2] = q.y(), out.orientation[3] = q.z();
    for (std::size_t i = 0; i < 3; ++i) {
      out.angular_velocity[i] = noisy(i, w[static_cast<Eigen::Index>(i)]);
      out.acceleration[i] = noisy(i + 3, f[static_cast<Eigen::Index>(i)]);
    }
  }

  void restart() override {
    has_velocity_ = false;
    acceleration_.setZero();
  }

  Mount mount_;
  bool has_orientation_;
  Eigen::Matrix3d reference_;  // columns: axes of the frame that the orientation is told against, in the world
  Eigen::Vector3d velocity_{0, 0, 0}, acceleration_{0, 0, 0};
  bool has_velocity_ = false;
};

}  // namespace

MadeDevice make_imu(const SensorSite& site) {
  const auto& def = std::get<ImuDef>(site.def.data);
  auto info = info_of<shm::ImuInfo>(site);
  info.angular_velocity_noise = stated_deviation(def.angular_velocity[0]);
  info.acceleration_noise = stated_deviation(def.linear_acceleration[0]);
  std::vector<NoiseDef> noises(def.angular_velocity.begin(), def.angular_velocity.end());
  noises.insert(noises.end(), def.linear_acceleration.begin(), def.linear_acceleration.end());
  return make_sensor<Imu>(site, shm::iface_spec(shm::IfaceType::imu, site.iface(), info), noises);
}

}  // namespace sim
