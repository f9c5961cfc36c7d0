#include "devices/drives/vehicle3d.h"

#include <algorithm>
#include <cmath>

#include "devices/drives/body.h"
#include "devices/drives/position3d.h"
#include "world/iface_names.h"

namespace sim {
namespace {

constexpr double goal_acceleration = 0.5;  // [m/s^2] that the way to a goal is planned with
constexpr double goal_speed = 1;           // [m/s] on it, where the vehicle has no limit

// A boat turns to the goal, and to the yaw of the goal when it is there.
void turn_ahead(Eigen::Vector4d& v, double distance) {
  constexpr double there = 0.3;  // [m]
  if (distance > there) {
    v[3] = 1.5 * std::atan2(v.y(), v.x());
    v.x() = std::max(v.x(), 0.0);
  }
  v.y() = 0;
}

}  // namespace

MadeDevice Vehicle3d::make(DeviceWorld& world, ModelId model, const PluginDef& plugin, std::shared_ptr<Propellers> propellers,
                           std::unique_ptr<VehicleControl> control) {
  const ModelDef& def = world.physics.def(model);
  shm::Position3dInfo info{};
  info.drive = RTMSIM_DRIVE_HOLONOMIC;
  describe_body(def, info.pose, info.size);
  info.max_speed = control->max_speed();
  info.max_yaw_rate = control->max_yaw_rate();
  info.rate = stated_rate(world, 0);
  shm::set_text(info.model, scoped_model(def, plugin.scope));
  auto setup = set_up(world, model, 0, shm::iface_spec(shm::IfaceType::position3d, iface_name(def, plugin), info), {});
  if (!setup) return setup.error();
  return MadeDevice(std::make_unique<Vehicle3d>(std::move(*setup), std::move(propellers), std::move(control)));
}

Vehicle3d::Vehicle3d(Setup setup, std::shared_ptr<Propellers> propellers, std::unique_ptr<VehicleControl> control)
    : Sensor(std::move(setup)), propellers_(std::move(propellers)), control_(std::move(control)) {
  odometry_origin_ = physics().model_pose(model()).inverse();
}

void Vehicle3d::take(const Moment& moment) {
  shm::Command command;
  switch (poll_command(moment, command)) {
    case shm::CommandChange::fresh:
      is_commanded_ = true;
      is_idle_ = false;
      goal_.reset();
      command_.setZero();
      if (command.kind == shm::CommandKind::velocity) {
        for (int i = 0; i < 6; ++i) command_[i] = command.values[static_cast<std::size_t>(i)];
      }
      if (command.kind == shm::CommandKind::pose) goal_ = {command.values[0], command.values[1], command.values[2], command.values[5]};
      break;
    case shm::CommandChange::lost:
      is_commanded_ = false;
      goal_.reset();
      command_.setZero();
      break;
    case shm::CommandChange::none:
      break;
  }
}

Vector6 Vehicle3d::wanted() const {
  if (halted_at_) return *halted_at_;
  if (!goal_) return strength_ * command_;
  const Eigen::Isometry3d pose = odometry_origin_ * physics().model_pose(model());
  Eigen::Vector4d v = velocity_towards(pose, goal_->head<3>(), (*goal_)[3], goal_acceleration);
  const double most = control_->max_speed() > 0 ? control_->max_speed() : goal_speed;
  if (const double speed = v.head<3>().norm(); speed > most) v.head<3>() *= most / speed;
  if (!control_->moves_sideways()) turn_ahead(v, (goal_->head<3>() - pose.translation()).head<2>().norm());
  const double turn = control_->max_yaw_rate();
  Vector6 out = Vector6::Zero();
  const Eigen::Matrix3d level = Eigen::AngleAxisd(yaw_of(pose), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  out.head<3>() = pose.linear().transpose() * level * v.head<3>();
  out[5] = std::clamp(v[3], -turn, turn);
  return strength_ * out;
}

void Vehicle3d::before_step(const Moment& moment) {
  take(moment);
  auto& wishes = propellers_->wishes;
  if (is_idle_ || !motors_enabled_) {
    followed_.setZero();
    std::fill(wishes.begin(), wishes.end(), Propellers::Wish{});
    return;
  }
  followed_ = wanted();
  control_->control(physics(), followed_, moment.dt, wishes);
}

void Vehicle3d::measure(const Moment&) const {
  auto& out = sample<shm::Position3dSample>();
  measure_body(physics(), model(), odometry_origin_, out);
  for (int i = 0; i < 6; ++i) out.command[i] = followed_[i];
  const double asked = followed_.head<3>().norm(), moved = Eigen::Map<const Eigen::Vector3d>(out.velocity).norm();
  out.stalled = asked > 0.1 && moved < 0.2 * asked ? 1 : 0;
  out.motors_enabled = motors_enabled_ ? 1 : 0;
  out.commanded = is_commanded_ ? 1 : 0;
}

void Vehicle3d::restart() {
  is_idle_ = motors_enabled_ = true;
  command_.setZero(), followed_.setZero();
  goal_.reset();
  halted_at_.reset();
  strength_ = 1;
  control_->reset();
  odometry_origin_ = physics().model_pose(model()).inverse();
}

void Vehicle3d::add_state_to(StateHash& hash) const {
  hash.add(writer().name());
  for (int i = 0; i < 6; ++i) hash.add_all(command_[i], followed_[i]);
  hash.add_all(std::uint64_t{is_idle_}, std::uint64_t{motors_enabled_});
  control_->add_to(hash);
}

bool Vehicle3d::set_odometry(const Eigen::Isometry3d& pose) {
  odometry_origin_ = pose * physics().model_pose(model()).inverse();
  return true;
}

// Without its motors it falls, or drifts.
bool Vehicle3d::set_motors(bool enabled) {
  motors_enabled_ = enabled;
  control_->reset();
  return true;
}

void Vehicle3d::set_fault(double strength, bool is_halted) {
  strength_ = strength;
  if (!is_halted) halted_at_.reset();
  if (is_halted && !halted_at_) halted_at_ = followed_;
}

}  // namespace sim
