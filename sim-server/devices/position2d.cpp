#include "devices/position2d.h"

#include <algorithm>
#include <cmath>

#include "world/iface_names.h"

namespace sim {
namespace {

constexpr double stall_after = 0.5;  // [s]

// Of all its boxes, spheres and cylinders, along the axes of the model.
Eigen::AlignedBox3d box_of(const ModelDef& model) {
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
  return box.isEmpty() ? Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()) : box;
}

}  // namespace

base::Result<std::unique_ptr<Device>> Position2d::make(DeviceWorld& world, ModelId model, const PluginDef& plugin,
                                                       std::unique_ptr<DriveTrain> train) {
  const ModelDef& def = world.physics.def(model);
  shm::Position2dInfo info{};
  const Eigen::AlignedBox3d box = box_of(def);
  const Eigen::Vector3d centre = box.center(), size = box.sizes();
  info.pose = shm::identity_pose;
  info.pose.x = centre.x();
  info.pose.y = centre.y();
  info.pose.z = centre.z();
  for (int i = 0; i < 3; ++i) info.size[i] = size[i];
  train->describe(info);
  info.rate = train->rate() > 0 ? train->rate() : 1 / world.world.physics.step;
  shm::set_text(info.model, scoped_model(def, plugin.scope));
  auto writer = world.shm.create(shm::position2d_spec(iface_name(def, plugin), info));
  if (!writer) return writer.error();
  return std::unique_ptr<Device>(new Position2d(world, model, info.wheel_separation, std::move(train), std::move(*writer)));
}

Position2d::Position2d(DeviceWorld& world, ModelId model, double separation, std::unique_ptr<DriveTrain> train,
                       std::unique_ptr<shm::IfaceWriter> writer)
    : world_(world),
      model_(model),
      separation_(separation),
      train_(std::move(train)),
      schedule_(train_->rate()),
      writer_(std::move(writer)) {}

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
  train_->drive(command_[0], command_[1], motors_enabled_, moment.dt);
}

void Position2d::after_step(const Moment& moment) {
  const Travel travel = train_->travel();
  odometry_[0] += travel.forward * std::cos(odometry_[2] + travel.turn / 2);
  odometry_[1] += travel.forward * std::sin(odometry_[2] + travel.turn / 2);
  odometry_[2] = wrapped(odometry_[2] + travel.turn);
  velocity_ = {travel.speed, travel.yaw_rate};
  // Stalled: the motors want to move, but the robot does not.
  const double wanted = train_->fastest_rim();
  if (wanted <= 0.02 || !motors_enabled_) {
    stalled_for_ = 0;
    return;
  }
  const Twist twist = world_.physics.link_twist(world_.physics.canonical_link(model_));
  const double moved = std::max(twist.linear.norm(), std::abs(twist.angular.z()) * separation_ / 2);
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
  const auto followed = train_->followed();
  sample.command[0] = followed[0];
  sample.command[1] = 0;
  sample.command[2] = followed[1];
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
  odometry_ = {0, 0, 0};
  velocity_ = {0, 0};
  command_ = {0, 0};
  motors_enabled_ = true;
  stalled_for_ = 0;
  train_->reset();
}

void Position2d::add_to(StateHash& hash) const {
  hash.add(writer_->name());
  for (const double value : {odometry_[0], odometry_[1], odometry_[2], command_[0], command_[1]}) hash.add(value);
  train_->add_to(hash);
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
