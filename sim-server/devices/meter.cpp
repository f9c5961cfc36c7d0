#include "devices/meter.h"

#include <algorithm>
#include <cmath>
#include "world/iface_names.h"

namespace sim {

namespace {

shm::IfaceType type_of(SensorKind kind) {
  switch (kind) {
    case SensorKind::force_torque:
      return shm::IfaceType::force_torque;
    case SensorKind::altimeter:
      return shm::IfaceType::altimeter;
    case SensorKind::magnetometer:
      return shm::IfaceType::magnetometer;
    default:
      return shm::IfaceType::air_pressure;
  }
}

std::vector<NoiseDef> noises_of(const SensorDef& sensor) {
  if (const auto* load = std::get_if<ForceTorqueDef>(&sensor.data)) {
    std::vector<NoiseDef> noises(load->force.begin(), load->force.end());
    noises.insert(noises.end(), load->torque.begin(), load->torque.end());
    return noises;
  }
  if (const auto* height = std::get_if<AltimeterDef>(&sensor.data)) return {height->vertical_position, height->vertical_velocity};
  if (const auto* field = std::get_if<MagnetometerDef>(&sensor.data)) return {field->field.begin(), field->field.end()};
  if (const auto* air = std::get_if<AirPressureDef>(&sensor.data)) return {air->pressure};
  return {};
}

double deviation(const NoiseDef& noise) { return noise.kind == NoiseDef::Kind::none ? 0 : noise.stddev; }

}  // namespace

double air_pressure_at(double altitude, double temperature, double pressure) {
  constexpr double lapse = 0.0065, gravity = 9.80665, molar_mass = 0.0289644, gas_constant = 8.31447;
  // The troposphere ends at 11 km; above it and far below the sea the formula would leave its range.
  const double share = 1 - lapse * std::clamp(altitude, -5000.0, 11000.0) / temperature;
  return share > 0 ? pressure * std::pow(share, gravity * molar_mass / (gas_constant * lapse)) : 0;
}

base::Result<std::unique_ptr<Device>> Meter::make(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::optional<JointId> joint) {
  const ModelDef& model = world.physics.def(mount.link.model);
  const std::vector<NoiseDef> noises = noises_of(sensor);
  shm::MeterInfo info{};
  info.rate = sensor.update_rate > 0 ? sensor.update_rate : 1 / world.world.physics.step;
  info.noise[0] = deviation(noises.front());
  if (sensor.kind == SensorKind::force_torque || sensor.kind == SensorKind::altimeter) info.noise[1] = deviation(noises.back());
  if (sensor.kind == SensorKind::altimeter) info.reference = mount.in_world(world.physics).translation().z();
  if (const auto* air = std::get_if<AirPressureDef>(&sensor.data)) {
    info.reference = air->reference_altitude != 0 ? air->reference_altitude : world.world.spherical.elevation;
  }
  info.pose = to_pose(model.links[mount.link.link].pose * mount.pose);
  shm::set_text(info.model, scoped_model(model, sensor.scope));
  if (joint) shm::set_text(info.joint, model.joints[joint->joint].name);
  auto writer = world.shm.create(shm::meter_spec(type_of(sensor.kind), iface_name(model, sensor), info));
  if (!writer) return writer.error();
  return std::unique_ptr<Device>(new Meter(world, mount, sensor, joint, info.reference, std::move(*writer)));
}

Meter::Meter(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::optional<JointId> joint, double reference,
             std::unique_ptr<shm::IfaceWriter> writer)
    : world_(world),
      mount_(mount),
      kind_(sensor.kind),
      joint_(joint),
      reference_(reference),
      schedule_(sensor.update_rate),
      writer_(std::move(writer)) {
  if (const auto* load = std::get_if<ForceTorqueDef>(&sensor.data)) load_ = *load;
  char channel = 'a';
  for (const NoiseDef& noise : noises_of(sensor)) noise_.emplace_back(noise, RandomStream(world.seed, writer_->name() + channel++));
  fresh_noise_ = noise_;
}

double Meter::noisy(std::size_t channel, double value) {
  const double dt = std::max(static_cast<double>(schedule_.period().count()) * 1e-9, world_.world.physics.step);
  return noise_[channel].apply(value, dt);
}

void Meter::measure_load() {
  auto& sample = writer_->sample<shm::ForceTorqueSample>();
  const Wrench load = world_.physics.joint_load(*joint_).value_or(Wrench{});
  const double sense = load_.measures_parent_to_child ? 1 : -1;
  const Eigen::Isometry3d sensor = mount_.in_world(world_.physics);
  const Eigen::Vector3d torque = load.torque + (load.place - sensor.translation()).cross(load.force);
  const JointDef& joint = world_.physics.def(joint_->model).joints[joint_->joint];
  Eigen::Matrix3d axes = sensor.linear();
  if (load_.frame != ForceTorqueDef::Frame::sensor) {
    const std::string& name = load_.frame == ForceTorqueDef::Frame::parent ? joint.parent : joint.child;
    const auto link = link_of(world_.physics.def(joint_->model), {}, name);
    axes = link ? Eigen::Matrix3d(world_.physics.link_pose({joint_->model, *link}).linear()) : Eigen::Matrix3d::Identity();
  }
  const Eigen::Vector3d f = sense * (axes.transpose() * load.force), t = sense * (axes.transpose() * torque);
  for (std::size_t i = 0; i < 3; ++i) {
    sample.force[i] = noisy(i, f[static_cast<Eigen::Index>(i)]);
    sample.torque[i] = noisy(i + 3, t[static_cast<Eigen::Index>(i)]);
  }
}

void Meter::measure_height() {
  const Eigen::Vector3d place = mount_.in_world(world_.physics).translation();
  auto& sample = writer_->sample<shm::AltimeterSample>();
  sample.height = noisy(0, place.z() - reference_);
  sample.climb = noisy(1, world_.physics.point_velocity(mount_.link, place).z());
}

void Meter::measure_field() {
  const Eigen::Vector3d field = mount_.in_world(world_.physics).linear().transpose() * world_.world.physics.magnetic_field;
  auto& sample = writer_->sample<shm::MagnetometerSample>();
  for (std::size_t i = 0; i < 3; ++i) sample.field[i] = noisy(i, field[static_cast<Eigen::Index>(i)]);
}

void Meter::measure_pressure() {
  const double altitude = reference_ + mount_.in_world(world_.physics).translation().z();
  const PhysicsDef& physics = world_.world.physics;
  writer_->sample<shm::AirPressureSample>().pressure =
      noisy(0, air_pressure_at(altitude, physics.atmosphere_temperature, physics.atmosphere_pressure));
}

void Meter::measure(const Moment&) {
  switch (kind_) {
    case SensorKind::force_torque:
      return measure_load();
    case SensorKind::altimeter:
      return measure_height();
    case SensorKind::magnetometer:
      return measure_field();
    default:
      return measure_pressure();
  }
}

void Meter::publish(const Moment& moment) {
  schedule_.done(moment.time);
  writer_->publish(moment.time);
}

void Meter::reset() {
  schedule_.restart();
  noise_ = fresh_noise_;
}

void Meter::add_to(StateHash& hash) const {
  for (const auto& noise : noise_) hash.add(noise.stream().position());
}

}  // namespace sim
