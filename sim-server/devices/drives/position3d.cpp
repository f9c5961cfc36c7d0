#include "devices/drives/position3d.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "devices/angle.h"
#include "devices/drives/body.h"
#include "world/iface_names.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

Eigen::Vector3d three(const std::optional<std::string>& text) {
  Eigen::Vector3d v(0, 0, 0);
  if (!text) return v;
  const auto parts = base::split_list(*text, ' ');
  for (std::size_t i = 0; i < 3 && i < parts.size(); ++i) v[static_cast<Eigen::Index>(i)] = base::parse_number(parts[i]).value_or(0);
  return v;
}

}  // namespace

Eigen::Vector4d velocity_towards(const Eigen::Isometry3d& pose, const Eigen::Vector3d& place, double yaw, double acceleration) {
  const double heading = yaw_of(pose);
  const Eigen::Vector3d error = Eigen::AngleAxisd(-heading, Eigen::Vector3d::UnitZ()) * (place - pose.translation());
  Eigen::Vector4d v(0, 0, 0, 1.5 * wrapped(yaw - heading));
  if (error.norm() > 1e-9) v.head<3>() = error.normalized() * std::min(1.5 * error.norm(), std::sqrt(acceleration * error.norm()));
  return v;
}

void measure_body(const Physics& physics, ModelId model, const Eigen::Isometry3d& odometry_origin, shm::Position3dSample& out) {
  const Eigen::Isometry3d pose = physics.model_pose(model);
  const LinkId link = physics.canonical_link(model);
  const Eigen::Vector3d v = pose.linear().transpose() * physics.point_velocity(link, pose.translation());
  const Eigen::Vector3d w = pose.linear().transpose() * physics.link_twist(link).angular;
  out.odometry = to_pose(odometry_origin * pose);
  out.true_pose = to_pose(pose);
  for (int i = 0; i < 3; ++i) {
    out.velocity[i] = out.true_velocity[i] = v[i];
    out.velocity[i + 3] = out.true_velocity[i + 3] = w[i];
  }
}

MadeDevice Position3d::make(DeviceWorld& world, ModelId model, const PluginDef& plugin, std::optional<Path> path) {
  const ModelDef& def = world.physics.def(model);
  shm::Position3dInfo info{};
  info.drive = RTMSIM_DRIVE_HOLONOMIC;
  describe_body(def, info.pose, info.size);
  info.max_speed = plugin.parameters.number_of({"max_speed", "max_linear_velocity"}).value_or(0);
  info.max_yaw_rate = plugin.parameters.number_of({"max_yaw_rate", "max_angular_velocity"}).value_or(0);
  info.rate = stated_rate(world, 0);
  shm::set_text(info.model, scoped_model(def, plugin.scope));
  auto setup = set_up(world, model, 0, shm::iface_spec(shm::IfaceType::position3d, iface_name(def, plugin), info), {});
  if (!setup) return setup.error();
  return MadeDevice(std::make_unique<Position3d>(std::move(*setup), plugin, std::move(path)));
}

Position3d::Position3d(Setup setup, const PluginDef& plugin, std::optional<Path> path) : Sensor(std::move(setup)), path_(std::move(path)) {
  const ParameterNode& p = plugin.parameters;
  const auto limit = [](std::optional<double> value, double otherwise) { return value && *value > 0 ? *value : otherwise; };
  max_speed_ = limit(p.number_of({"max_speed", "max_linear_velocity"}), path_ ? 2 * path_->speed() : 100);
  max_yaw_rate_ = limit(p.number_of({"max_yaw_rate", "max_angular_velocity"}), 10);
  max_acceleration_ = limit(p.number_of({"max_acceleration", "max_linear_acceleration"}), 5);
  max_yaw_acceleration_ = limit(p.number_of({"max_yaw_acceleration", "max_angular_acceleration"}), 5);
  initial_command_.head<3>() = three(p.text_of({"initial_linear"}));
  initial_command_[3] = three(p.text_of({"initial_angular"})).z();
  is_kinematic_ = kind_of(plugin) == PluginKind::trajectory_follower;
  restart();
}

Eigen::Vector4d Position3d::to_goal(const Eigen::Isometry3d& pose) const {
  return velocity_towards(odometry_origin_ * pose, goal_->head<3>(), (*goal_)[3], max_acceleration_);
}

void Position3d::move(const Eigen::Isometry3d& pose, const Eigen::Vector3d& velocity, double yaw_rate) {
  // Level again after a bump: turn the body's up towards the world's.
  const Eigen::Vector3d up = pose.linear().col(2);
  Twist twist;
  twist.angular = 2 * up.cross(Eigen::Vector3d::UnitZ()) + Eigen::Vector3d(0, 0, yaw_rate);
  const Eigen::Vector3d arm = physics().link_pose(physics().canonical_link(model())).translation() - pose.translation();
  twist.linear = velocity + twist.angular.cross(arm);
  (void)world().physics.set_model_twist(model(), twist);  // values are within the limits
}

// Moves to where the path is at the end of the step; false when that is further than the path goes in a step: it was pushed or led away.
bool Position3d::keep_to_path(const Moment& moment, const Eigen::Isometry3d& pose) {
  const Eigen::Isometry3d next = path_->at(path_time_ + moment.dt);
  const Eigen::Vector3d way = next.translation() - pose.translation();
  const double turn = wrapped(yaw_of(next) - yaw_of(pose));
  if (way.norm() > 2 * path_->speed() * moment.dt + 1e-3) return false;
  if (std::abs(turn) > 2 * std::max(path_->turn_rate(), path_->speed()) * moment.dt + 0.02) return false;
  path_time_ += moment.dt;
  const Eigen::Vector3d velocity = way / moment.dt;
  velocity_.head<3>() = Eigen::AngleAxisd(-yaw_of(pose), Eigen::Vector3d::UnitZ()) * velocity;
  velocity_[3] = turn / moment.dt;
  move(pose, velocity, velocity_[3]);
  return true;
}

void Position3d::before_step(const Moment& moment) {
  shm::Command command;
  switch (poll_command(moment, command)) {
    case shm::CommandChange::fresh:
      is_commanded_ = true;
      if (is_idle_) begin();
      goal_.reset();
      command_.setZero();
      if (command.kind == shm::CommandKind::velocity)
        command_ = {command.values[0], command.values[1], command.values[2], command.values[5]};
      if (command.kind == shm::CommandKind::pose)
        goal_ = Eigen::Vector4d(command.values[0], command.values[1], command.values[2], command.values[5]);
      break;
    case shm::CommandChange::lost:
      is_commanded_ = false;
      goal_.reset();
      command_.setZero();
      break;
    case shm::CommandChange::none:
      break;
  }
  if (!can_fly() || is_idle_) return;
  const Eigen::Isometry3d pose = physics().model_pose(model());
  const bool is_on_the_way = path_ && !is_commanded_;
  if (is_on_the_way && keep_to_path(moment, pose)) return;
  Eigen::Vector4d wanted = halted_at_ ? *halted_at_ : strength_ * (goal_ ? to_goal(pose) : command_);
  if (is_on_the_way) {
    const Eigen::Isometry3d back = path_->at(path_time_);
    wanted = velocity_towards(pose, back.translation(), yaw_of(back), max_acceleration_);
  }
  if (const double speed = wanted.head<3>().norm(); speed > max_speed_) wanted.head<3>() *= max_speed_ / speed;
  wanted[3] = std::clamp(wanted[3], -max_yaw_rate_, max_yaw_rate_);
  const Eigen::Vector3d change = wanted.head<3>() - velocity_.head<3>();
  const double most = max_acceleration_ * moment.dt;
  velocity_.head<3>() += change.norm() > most ? (change * (most / change.norm())).eval() : change;
  velocity_[3] += std::clamp(wanted[3] - velocity_[3], -max_yaw_acceleration_ * moment.dt, max_yaw_acceleration_ * moment.dt);
  move(pose, Eigen::AngleAxisd(yaw_of(pose), Eigen::Vector3d::UnitZ()) * velocity_.head<3>(), velocity_[3]);
}

void Position3d::measure(const Moment&) const {
  auto& out = sample<shm::Position3dSample>();
  measure_body(physics(), model(), odometry_origin_, out);
  for (int i = 0; i < 3; ++i) {
    out.command[i] = velocity_[i];
    out.command[i + 3] = i == 2 ? velocity_[3] : 0;
  }
  const Eigen::Map<const Eigen::Vector3d> v(out.velocity);
  out.stalled = velocity_.head<3>().norm() > 0.1 && v.norm() < 0.2 * velocity_.head<3>().norm() ? 1 : 0;
  out.motors_enabled = can_fly() ? 1 : 0;
  out.commanded = is_commanded_ ? 1 : 0;
}

// From now on it is moved. Until then it falls and rolls as any other body does.
void Position3d::begin() {
  is_idle_ = false;
  world().physics.set_gravity(model(), !can_fly());
}

void Position3d::restart() {
  is_idle_ = !path_ && initial_command_.isZero();
  world().physics.set_gravity(model(), is_idle_);
  if (is_kinematic_) world().physics.make_kinematic(model());
  command_ = initial_command_;
  velocity_.setZero();
  goal_.reset();
  halted_at_.reset();
  path_time_ = 0;
  motors_enabled_ = has_power_ = true;
  odometry_origin_ = physics().model_pose(model()).inverse();
}

void Position3d::add_state_to(StateHash& hash) const {
  hash.add(writer().name());
  for (int i = 0; i < 4; ++i) hash.add(velocity_[i]), hash.add(command_[i]);
  if (path_) hash.add(path_time_);
  if (is_idle_) hash.add(std::uint64_t{1});
}

bool Position3d::set_odometry(const Eigen::Isometry3d& pose) {
  odometry_origin_ = pose * physics().model_pose(model()).inverse();
  return true;
}

void Position3d::set_fault(double strength, bool is_halted) {
  strength_ = strength;
  if (!is_halted) halted_at_.reset();
  if (is_halted && !halted_at_) halted_at_ = velocity_;
}

// Without its motors it falls.
bool Position3d::set_motors(bool enabled) {
  motors_enabled_ = enabled;
  world().physics.set_gravity(model(), !can_fly() || is_idle_);
  velocity_.setZero();
  if (is_kinematic_ && !can_fly()) (void)world().physics.set_model_twist(model(), {});  // it would go on as it was told last
  return true;
}

void Position3d::set_power(bool has_power) {
  has_power_ = has_power;
  (void)set_motors(motors_enabled_);
}

}  // namespace sim
