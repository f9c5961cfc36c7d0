#include "devices/drives/position2d.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "devices/angle.h"
#include "devices/drives/body.h"
#include "world/iface_names.h"

namespace sim {
MadeDevice Position2d::make(DeviceWorld& world, ModelId model, const PluginDef& plugin, std::unique_ptr<DriveTrain> train) {
  const ModelDef& def = world.physics.def(model);
  shm::Position2dInfo info{};
  describe_body(def, info.pose, info.size);
  train->describe(info);
  info.rate = stated_rate(world, train->rate());
  shm::set_text(info.model, scoped_model(def, plugin.scope));
  auto setup = set_up(world, model, train->rate(), shm::iface_spec(shm::IfaceType::position2d, iface_name(def, plugin), info), {});
  if (!setup) return setup.error();
  const Traction traction(info.wheel_separation, info.drive == RTMSIM_DRIVE_SKID);
  return MadeDevice(std::make_unique<Position2d>(std::move(*setup), traction, std::move(train), info.drive));
}

Position2d::Position2d(Setup setup, const Traction& traction, std::unique_ptr<DriveTrain> train, std::uint32_t drive)
    : Sensor(std::move(setup)), train_(std::move(train)), drive_(drive), traction_(traction) {}

// What the drive cannot do is nothing: it stands.
DriveOrder Position2d::order_of(const shm::Command& command) const {
  DriveOrder order;
  if (command.kind == shm::CommandKind::velocity)
    order.velocity = {command.values[0], drive_ == RTMSIM_DRIVE_HOLONOMIC ? command.values[1] : 0, command.values[2]};
  if (command.kind == shm::CommandKind::car && drive_ == RTMSIM_DRIVE_CAR) {
    order.velocity[0] = command.values[0];
    order.steering = command.values[1];
  }
  return order;
}

void Position2d::before_step(const Moment& moment) {
  shm::Command command;
  switch (poll_command(moment, command)) {
    case shm::CommandChange::fresh:
      is_commanded_ = true;
      command_ = order_of(command);
      break;
    case shm::CommandChange::lost:
      is_commanded_ = false;
      command_ = {};
      break;
    case shm::CommandChange::none:
      break;
  }
  DriveOrder order = halted_at_ ? *halted_at_ : command_;
  for (double& value : order.velocity) value *= strength_;
  train_->drive(order, can_drive(), moment.dt);
}

void Position2d::after_step(const Moment& moment) {
  const Travel travel = train_->travel();
  const double c = std::cos(odometry_[2] + travel.turn / 2), s = std::sin(odometry_[2] + travel.turn / 2);
  odometry_[0] += travel.forward * c - travel.aside * s;
  odometry_[1] += travel.forward * s + travel.aside * c;
  odometry_[2] = wrapped(odometry_[2] + travel.turn);
  velocity_ = {travel.speed, travel.side_speed, travel.yaw_rate};
  if (!train_->moves_the_model()) return;
  if (!traction_.follow(can_drive() ? train_->followed() : std::array{0.0, 0.0, 0.0}, travel, moment.dt)) return;
  const std::string line = traction_.look(physics().model_pose(model()));
  if (!line.empty()) base::log(base::Level::warn, writer().name(), "{}", line);
}

void Position2d::measure(const Moment&) const {
  auto& out = sample<shm::Position2dSample>();
  for (std::size_t i = 0; i < 3; ++i) out.odometry[i] = odometry_[i], out.velocity[i] = velocity_[i];
  const Eigen::Isometry3d pose = physics().model_pose(model());
  out.true_pose = to_pose(pose);
  const LinkId link = physics().canonical_link(model());
  const Twist twist = physics().link_twist(link);
  const Eigen::Vector3d v = pose.linear().transpose() * physics().point_velocity(link, pose.translation());
  const Eigen::Vector3d w = pose.linear().transpose() * twist.angular;
  out.true_velocity[0] = v.x();
  out.true_velocity[1] = v.y();
  out.true_velocity[2] = w.z();
  const auto followed = train_->followed();
  for (std::size_t i = 0; i < 3; ++i) out.command[i] = followed[i];
  out.stalled = traction_.is_stalled() ? 1 : 0;
  out.motors_enabled = can_drive() ? 1 : 0;
  out.commanded = is_commanded_ ? 1 : 0;
}

void Position2d::restart() {
  odometry_ = velocity_ = {0, 0, 0};
  command_ = {};
  motors_enabled_ = has_power_ = true;
  halted_at_.reset();
  traction_.restart();
  train_->reset();
}

void Position2d::add_state_to(StateHash& hash) const {
  hash.add(writer().name());
  for (const double value : {odometry_[0], odometry_[1], odometry_[2], command_.velocity[0], command_.velocity[2]}) hash.add(value);
  // Only where they can be: others keep their hashes.
  if (drive_ == RTMSIM_DRIVE_HOLONOMIC) hash.add(command_.velocity[1]);
  if (command_.steering) hash.add(*command_.steering);
  train_->add_to(hash);
  hash.add(std::uint64_t{motors_enabled_});
}

bool Position2d::set_odometry(const Eigen::Isometry3d& pose) {
  odometry_ = {pose.translation().x(), pose.translation().y(), yaw_of(pose)};
  return true;
}

void Position2d::set_fault(double strength, bool is_halted) {
  strength_ = strength;
  if (!is_halted) halted_at_.reset();
  if (is_halted && !halted_at_) halted_at_ = command_;
}

bool Position2d::is_working() const {
  const auto followed = train_->followed();
  return std::any_of(followed.begin(), followed.end(), [](double speed) { return speed != 0; });
}

bool Position2d::set_motors(bool enabled) {
  motors_enabled_ = enabled;
  return true;
}

}  // namespace sim
