#include "devices/position2d.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

constexpr double stall_after = 0.5;       // [s]
constexpr double strongest_torque = 1e6;  // [N m] of wheels that nothing but their grip holds back

// gz-sim turns wheels as told whatever it takes; in Gazebo classic they have 5 N m when nothing is said.
bool is_of_gz_sim(const PluginDef& plugin) {
  return plugin.name.find("::systems::") != std::string::npos || plugin.filename.find("gz-sim") != std::string::npos ||
         plugin.filename.find("ignition-gazebo") != std::string::npos;
}

// All joints that the children of these names mean.
void add_joints(const ModelDef& model, const PluginDef& plugin, std::initializer_list<std::string_view> spellings,
                std::vector<std::uint32_t>& joints, std::string& missing) {
  for (const auto& child : plugin.parameters.children) {
    if (std::find(spellings.begin(), spellings.end(), child.name) == spellings.end()) continue;
    if (const auto joint = joint_of(model, plugin.scope, child.text)) {
      // Models that serve several simulators name the same joint in several spellings.
      if (std::find(joints.begin(), joints.end(), *joint) == joints.end()) joints.push_back(*joint);
    } else {
      missing = child.text;
    }
  }
}

// Radius of the round collision or the height of the box of the wheel that a joint turns.
double wheel_radius(const ModelDef& model, std::uint32_t joint) {
  const LinkDef* wheel = model.link(model.joints[joint].child);
  if (wheel == nullptr) return 0;
  for (const auto& collision : wheel->collisions) {
    if (const auto* sphere = std::get_if<SphereShape>(&collision.geometry)) return sphere->radius;
    if (const auto* cylinder = std::get_if<CylinderShape>(&collision.geometry)) return cylinder->radius;
  }
  return 0;
}

// What the joints' own limits allow.
double torque_of_joints(const ModelDef& model, const std::vector<std::uint32_t>& left, const std::vector<std::uint32_t>& right) {
  double torque = strongest_torque;
  for (const auto* side : {&left, &right}) {
    for (const auto joint : *side) {
      if (model.joints[joint].axes.empty()) continue;
      if (const double effort = model.joints[joint].axes[0].effort; effort > 0) torque = std::min(torque, effort);
    }
  }
  return torque;
}

double wheel_separation(const ModelDef& model, std::uint32_t left, std::uint32_t right) {
  const Eigen::Vector3d between = model.joints[left].pose_in_model.translation() - model.joints[right].pose_in_model.translation();
  return between.head<2>().norm();
}

std::array<double, 3> size_of(const ModelDef& model) {
  Eigen::AlignedBox3d box;
  for (const auto& link : model.links) {
    for (const auto& collision : link.collisions) {
      Eigen::Vector3d half = Eigen::Vector3d::Zero();
      if (const auto* b = std::get_if<BoxShape>(&collision.geometry)) half = b->size / 2;
      if (const auto* s = std::get_if<SphereShape>(&collision.geometry)) half.setConstant(s->radius);
      if (const auto* c = std::get_if<CylinderShape>(&collision.geometry)) half = {c->radius, c->radius, c->length / 2};
      const Eigen::Isometry3d pose = link.pose * collision.pose;
      const Eigen::Vector3d reach = pose.linear().cwiseAbs() * half;
      box.extend((pose.translation() - reach).eval());
      box.extend((pose.translation() + reach).eval());
    }
  }
  if (box.isEmpty()) return {0, 0, 0};
  return {box.sizes().x(), box.sizes().y(), box.sizes().z()};
}

double wrapped(double angle) { return std::remainder(angle, 2 * 3.14159265358979323846); }

}  // namespace

base::Result<DriveSettings> DriveSettings::of(const ModelDef& model, const PluginDef& plugin) {
  const ParameterNode& p = plugin.parameters;
  DriveSettings s;
  s.is_skid = kind_of(plugin) == PluginKind::skid_steer_drive;
  std::string missing;
  add_joints(
      model, plugin,
      {"left_joint", "leftJoint", "left_front", "leftFrontJoint", "left_front_joint", "left_rear", "leftRearJoint", "left_rear_joint"},
      s.left, missing);
  add_joints(model, plugin,
             {"right_joint", "rightJoint", "right_front", "rightFrontJoint", "right_front_joint", "right_rear", "rightRearJoint",
              "right_rear_joint"},
             s.right, missing);
  if (!missing.empty())
    return base::Error{
        fmt::format("{}: plugin {}: model {} has no joint {}", plugin.source, plugin.name, model.name, base::in_quotes(missing))};
  if (s.left.empty() || s.right.empty()) {
    return base::Error{fmt::format("{}: plugin {}: needs a left and a right joint (left_joint, right_joint)", plugin.source, plugin.name)};
  }
  s.separation =
      p.number_of({"wheel_separation", "wheelSeparation", "wheel_track"}).value_or(wheel_separation(model, s.left[0], s.right[0]));
  s.radius = p.number_of({"wheel_radius", "wheelRadius"})
                 .value_or(p.number_of({"wheel_diameter", "wheelDiameter"}).value_or(2 * wheel_radius(model, s.left[0])) / 2);
  if (s.separation <= 0 || s.radius <= 0) {
    return base::Error{fmt::format("{}: plugin {}: wheel separation and radius must be positive, got {} and {}", plugin.source, plugin.name,
                                   s.separation, s.radius)};
  }
  s.torque = p.number_of({"max_wheel_torque", "wheelTorque", "wheel_torque", "torque", "max_force", "MaxForce"})
                 .value_or(is_of_gz_sim(plugin) ? torque_of_joints(model, s.left, s.right) : s.torque);
  if (s.torque <= 0) s.torque = 5;
  s.max_speed = std::max(0.0, p.number_of({"max_linear_velocity", "max_velocity", "max_speed", "maxSpeed"}).value_or(0));
  s.max_yaw_rate = std::max(0.0, p.number_of({"max_angular_velocity", "max_yaw_rate", "max_turnrate"}).value_or(0));
  s.max_acceleration = std::max(
      0.0, p.number_of({"max_wheel_acceleration", "max_linear_acceleration", "max_acceleration", "wheelAcceleration", "wheel_acceleration"})
               .value_or(0));
  s.max_yaw_acceleration = std::max(0.0, p.number_of({"max_angular_acceleration", "max_yaw_acceleration"}).value_or(0));
  s.rate = std::max(0.0, p.number_of({"odom_publish_frequency", "update_rate", "updateRate"}).value_or(0));
  return s;
}

base::Result<std::unique_ptr<Device>> Position2d::make(DeviceWorld& world, ModelId model, const PluginDef& plugin) {
  const ModelDef& def = world.physics.def(model);
  auto settings = DriveSettings::of(def, plugin);
  if (!settings) return settings.error();
  shm::Position2dInfo info{};
  info.drive = settings->is_skid ? RTMSIM_DRIVE_SKID : RTMSIM_DRIVE_DIFFERENTIAL;
  info.pose = shm::identity_pose;
  const auto size = size_of(def);
  std::copy(size.begin(), size.end(), info.size);
  info.max_speed = settings->max_speed;
  info.max_yaw_rate = settings->max_yaw_rate;
  info.max_acceleration = settings->max_acceleration;
  info.max_yaw_acceleration = settings->max_yaw_acceleration;
  info.wheel_separation = settings->separation;
  info.wheel_radius = settings->radius;
  info.rate = settings->rate > 0 ? settings->rate : 1 / world.world.physics.step;
  shm::set_text(info.model, scoped_model(def, plugin.scope));
  auto writer = world.shm.create(shm::position2d_spec(iface_name(def.name, plugin.scope, iface_own_name(plugin)), info));
  if (!writer) return writer.error();
  return std::unique_ptr<Device>(new Position2d(world, model, *settings, std::move(*writer)));
}

Position2d::Position2d(DeviceWorld& world, ModelId model, const DriveSettings& settings, std::unique_ptr<shm::IfaceWriter> writer)
    : world_(world), model_(model), settings_(settings), schedule_(settings.rate), writer_(std::move(writer)) {
  read_angles();
}

void Position2d::read_angles() {
  left_angles_.clear();
  right_angles_.clear();
  for (const auto joint : settings_.left) left_angles_.push_back(world_.physics.joint_state({model_, joint}).position);
  for (const auto joint : settings_.right) right_angles_.push_back(world_.physics.joint_state({model_, joint}).position);
}

void Position2d::before_step(const Moment& moment) {
  shm::Command command;
  switch (writer_->poll_command(command)) {
    case shm::CommandChange::fresh:
      is_commanded_ = true;
      command_ = {0, 0};
      if (command.kind == RTMSIM_COMMAND_VELOCITY) command_ = {command.values[0], command.values[2]};
      break;
    case shm::CommandChange::lost:
      is_commanded_ = false;
      command_ = {0, 0};
      break;
    case shm::CommandChange::none:
      break;
  }
  const auto limited = [](double value, double limit) {
    return limit > 0 ? std::clamp(value, -limit, limit) : std::clamp(value, -1000.0, 1000.0);
  };
  const double vx = limited(command_[0], settings_.max_speed), va = limited(command_[1], settings_.max_yaw_rate);
  const double half = settings_.separation / 2;
  std::array<double, 2> change{vx - va * half - wheels_[0], vx + va * half - wheels_[1]};
  double share = 1;
  const double fastest_change = std::max(std::abs(change[0]), std::abs(change[1]));
  // Both wheels take the same share of their change, so that the robot keeps to its curve while it speeds up or brakes.
  if (settings_.max_acceleration > 0 && fastest_change > 0)
    share = std::min(share, settings_.max_acceleration * moment.dt / fastest_change);
  const double turn_change = std::abs(change[1] - change[0]) / settings_.separation;
  if (settings_.max_yaw_acceleration > 0 && turn_change > 0)
    share = std::min(share, settings_.max_yaw_acceleration * moment.dt / turn_change);
  for (std::size_t side = 0; side < 2; ++side) {
    wheels_[side] = motors_enabled_ ? wheels_[side] + share * change[side] : 0;
    for (const auto joint : side == 0 ? settings_.left : settings_.right) {
      world_.physics.set_motor({model_, joint}, 0, wheels_[side] / settings_.radius, motors_enabled_ ? settings_.torque : 0);
    }
  }
}

double Position2d::turned(const std::vector<std::uint32_t>& joints, std::vector<double>& angles, double& rate) {
  double sum = 0;
  rate = 0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointState state = world_.physics.joint_state({model_, joints[i]});
    sum += wrapped(state.position - angles[i]);
    angles[i] = state.position;
    rate += state.velocity;
  }
  rate /= static_cast<double>(joints.size());
  return sum / static_cast<double>(joints.size());
}

void Position2d::after_step(const Moment& moment) {
  double left_rate = 0, right_rate = 0;
  const double left = settings_.radius * turned(settings_.left, left_angles_, left_rate);
  const double right = settings_.radius * turned(settings_.right, right_angles_, right_rate);
  const double forward = (left + right) / 2, turn = (right - left) / settings_.separation;
  odometry_[0] += forward * std::cos(odometry_[2] + turn / 2);
  odometry_[1] += forward * std::sin(odometry_[2] + turn / 2);
  odometry_[2] = wrapped(odometry_[2] + turn);
  velocity_ = {settings_.radius * (left_rate + right_rate) / 2, settings_.radius * (right_rate - left_rate) / settings_.separation};
  // Stalled: the motors want to move, but the robot does not.
  const double wanted = std::max(std::abs(wheels_[0]), std::abs(wheels_[1]));
  if (wanted <= 0.02 || !motors_enabled_) {
    stalled_for_ = 0;
    return;
  }
  const Twist twist = world_.physics.link_twist(world_.physics.canonical_link(model_));
  const double moved = std::max(twist.linear.norm(), std::abs(twist.angular.z()) * settings_.separation / 2);
  stalled_for_ = moved < 0.2 * wanted ? stalled_for_ + moment.dt : 0;
}

bool Position2d::wants_sample(const Moment& moment) { return schedule_.is_due(moment.time) && writer_->is_subscribed(); }

void Position2d::measure(const Moment&) {
  auto& sample = writer_->sample<shm::Position2dSample>();
  for (std::size_t i = 0; i < 3; ++i) sample.odometry[i] = odometry_[i];
  sample.velocity[0] = velocity_[0];
  sample.velocity[1] = 0;
  sample.velocity[2] = velocity_[1];
  const Eigen::Isometry3d pose = world_.physics.model_pose(model_);
  sample.true_pose = to_pose(pose);
  const LinkId link = world_.physics.canonical_link(model_);
  const Twist twist = world_.physics.link_twist(link);
  const Eigen::Vector3d v = pose.linear().transpose() * world_.physics.point_velocity(link, pose.translation());
  const Eigen::Vector3d w = pose.linear().transpose() * twist.angular;
  sample.true_velocity[0] = v.x();
  sample.true_velocity[1] = v.y();
  sample.true_velocity[2] = w.z();
  sample.command[0] = (wheels_[0] + wheels_[1]) / 2;
  sample.command[1] = 0;
  sample.command[2] = (wheels_[1] - wheels_[0]) / settings_.separation;
  sample.stalled = stalled_for_ > stall_after ? 1 : 0;
  sample.motors_enabled = motors_enabled_ ? 1 : 0;
  sample.commanded = is_commanded_ ? 1 : 0;
}

void Position2d::publish(const Moment& moment) {
  schedule_.done(moment.time);
  writer_->publish(moment.time);
}

void Position2d::reset() {
  schedule_.restart();
  wheels_ = {0, 0};
  odometry_ = {0, 0, 0};
  velocity_ = {0, 0};
  command_ = {0, 0};
  motors_enabled_ = true;
  stalled_for_ = 0;
  read_angles();
}

void Position2d::add_to(StateHash& hash) const {
  hash.add(writer_->name());
  for (const double value : {odometry_[0], odometry_[1], odometry_[2], wheels_[0], wheels_[1], command_[0], command_[1]}) hash.add(value);
  hash.add(std::uint64_t{motors_enabled_});
}

bool Position2d::set_odometry(const Eigen::Isometry3d& pose) {
  odometry_ = {pose.translation().x(), pose.translation().y(), yaw_of(pose)};
  return true;
}

bool Position2d::set_motors(bool enabled) {
  motors_enabled_ = enabled;
  return true;
}

}  // namespace sim
