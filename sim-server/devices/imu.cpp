#include "devices/simple_devices.h"
#include "world/iface_names.h"

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

}  // namespace

base::Result<std::unique_ptr<Device>> Imu::make(DeviceWorld& world, Mount mount, const SensorDef& sensor) {
  const ModelDef& model = world.physics.def(mount.link.model);
  const auto& def = std::get<ImuDef>(sensor.data);
  shm::ImuInfo info{};
  info.rate = sensor.update_rate > 0 ? sensor.update_rate : 1 / world.world.physics.step;
  info.angular_velocity_noise = def.angular_velocity[0].kind == NoiseDef::Kind::none ? 0 : def.angular_velocity[0].stddev;
  info.acceleration_noise = def.linear_acceleration[0].kind == NoiseDef::Kind::none ? 0 : def.linear_acceleration[0].stddev;
  info.pose = to_pose(model.links[mount.link.link].pose * mount.pose);
  shm::set_text(info.model, scoped_model(model, sensor.scope));
  auto writer = world.shm.create(shm::imu_spec(iface_name(model, sensor), info));
  if (!writer) return writer.error();
  return std::unique_ptr<Device>(new Imu(world, mount, sensor, std::move(*writer)));
}

Imu::Imu(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::unique_ptr<shm::IfaceWriter> writer)
    : world_(world), mount_(mount), schedule_(sensor.update_rate), writer_(std::move(writer)) {
  const auto& def = std::get<ImuDef>(sensor.data);
  for (std::size_t i = 0; i < 6; ++i) {
    const NoiseDef& noise = i < 3 ? def.angular_velocity[i] : def.linear_acceleration[i - 3];
    noise_[i] = Noise(noise, RandomStream(world.seed, writer_->name() + static_cast<char>('a' + i)));
  }
  fresh_noise_ = noise_;
  has_orientation_ = def.has_orientation;
  reference_ = reference_axes(def, world.world.spherical.heading);
}

void Imu::after_step(const Moment& moment) {
  // Always, so that the first sample of who comes later is right as well.
  const Eigen::Vector3d velocity = world_.physics.point_velocity(mount_.link, mount_.in_world(world_.physics).translation());
  acceleration_ = has_velocity_ ? ((velocity - velocity_) / moment.dt).eval() : Eigen::Vector3d::Zero();
  velocity_ = velocity;
  has_velocity_ = true;
}

void Imu::measure(const Moment&) {
  const Eigen::Isometry3d pose = mount_.in_world(world_.physics);
  const Eigen::Matrix3d to_sensor = pose.linear().transpose();
  const Eigen::Vector3d w = to_sensor * world_.physics.link_twist(mount_.link).angular;
  const Eigen::Vector3d f = to_sensor * (acceleration_ - world_.world.physics.gravity);
  auto& sample = writer_->sample<shm::ImuSample>();
  const Eigen::Quaterniond q =
      has_orientation_ ? Eigen::Quaterniond(reference_.transpose() * pose.linear()) : Eigen::Quaterniond::Identity();
  sample.orientation[0] = q.w(), sample.orientation[1] = q.x(), sample.orientation[2] = q.y(), sample.orientation[3] = q.z();
  const double dt = std::max(static_cast<double>(schedule_.period().count()) * 1e-9, world_.world.physics.step);
  for (std::size_t i = 0; i < 3; ++i) {
    sample.angular_velocity[i] = noise_[i].apply(w[static_cast<Eigen::Index>(i)], dt);
    sample.acceleration[i] = noise_[i + 3].apply(f[static_cast<Eigen::Index>(i)], dt);
  }
}

void Imu::publish(const Moment& moment) {
  schedule_.done(moment.time);
  writer_->publish(moment.time);
}

void Imu::show(const Moment& moment) {
  const auto before = noise_;
  Device::show(moment);
  noise_ = before;
}

void Imu::reset() {
  schedule_.restart();
  noise_ = fresh_noise_;
  has_velocity_ = false;
  acceleration_.setZero();
}

void Imu::add_to(StateHash& hash) const {
  for (const auto& noise : noise_) hash.add(noise.stream().position());
}

}  // namespace sim
