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
  return MadeDevice(std::make_unique<Position2d>(std::move(*setup), traction, std::move(train)));
}

Position2d::Position2d(Setup setup, const Traction& traction, std::unique_ptr<DriveTrain> train)
    : Sensor(std::move(setup)), train_(std::move(train)), traction_(traction) {}

void Position2d::before_step(const Moment& moment) {
  shm::Command command;
  switch (poll_command(moment, command)) {
    case shm::CommandChange::fresh:
      is_commanded_ = true;
      command_ = {0, 0};
      if (command.kind == shm::CommandKind::velocity) command_ = {command.values[0], command.values[2]};
      break;
    case shm::CommandChange::lost:
      is_commanded_ = false;
      command_ = {0, 0};
      break;
    case shm::CommandChange::none:
      break;
  }
  const auto& followed = halted_at_ ? *halted_at_ : command_;
  train_->drive(strength_ * followed[0], strength_ * followed[1], can_drive(), moment.dt);
}

void Position2d::after_step(const Moment& moment) {
  const Travel travel = train_->travel();
  odometry_[0] += travel.forward * std::cos(odometry_[2] + travel.turn / 2);
  odometry_[1] += travel.forward * std::sin(odometry_[2] + travel.turn / 2);
  odometry_[2] = wrapped(odometry_[2] + travel.turn);
  velocity_ = {travel.speed, travel.yaw_rate};
  if (!traction_.follow(can_drive() ? train_->followed() : std::array{0.0, 0.0}, travel, moment.dt)) return;
  const std::string line = traction_.look(physics().model_pose(model()));
  if (!line.empty()) base::log(base::Level::warn, writer().name(), "{}", line);
}

void Position2d::measure(const Moment&) const {
  auto& out = sample<shm::Position2dSample>();
  for (std::size_t i = 0; i < 3; ++i) out.odometry[i] = odometry_[i];
  out.velocity[0] = velocity_[0];
  out.velocity[1] = 0;
  out.velocity[2] = velocity_[1];
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
  out.command[0] = followed[0];
  out.command[1] = 0;
  out.command[2] = followed[1];
  out.stalled = traction_.is_stalled() ? 1 : 0;
  out.motors_enabled = can_drive() ? 1 : 0;
  out.commanded = is_commanded_ ? 1 : 0;
}

void Position2d::restart() {
  odometry_ = {0, 0, 0};
  velocity_ = {0, 0};
  command_ = {0, 0};
  motors_enabled_ = has_power_ = true;
  halted_at_.reset();
  traction_.restart();
  train_->reset();
}

void Position2d::add_state_to(StateHash& hash) const {
  hash.add(writer().name());
  for (const double value : {odometry_[0], odometry_[1], odometry_[2], command_[0], command_[1]}) hash.add(value);
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
  return followed[0] != 0 || followed[1] != 0;
}

bool Position2d::set_motors(bool enabled) {
  motors_enabled_ = enabled;
  return true;
}

}  // namespace sim
