// What is done to models from outside: poses, speeds, pushes, motors, and what is attached to what.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "physics/physics_impl.h"

namespace sim {

base::Result<void> Physics::set_model_pose(ModelId model, const Eigen::Isometry3d& pose) {
  if (!pose.matrix().allFinite() || !is_sane(pose.translation(), 1e8)) {
    return base::Error{fmt::format("model {}: pose must be finite and within 1e8 m of the origin, got {:g} {:g} {:g}", def(model).name,
                                   pose.translation().x(), pose.translation().y(), pose.translation().z())};
  }
  ModelInstance& instance = impl_->at(model);
  const bool has_anchors = std::any_of(instance.blueprint().assemblies.begin(), instance.blueprint().assemblies.end(),
                                       [](const Assembly& assembly) { return assembly.is_anchored; });
  impl_->drop_welds([&](const Weld& weld) { return weld.is_of(instance); });
  instance.stop_rolling();
  const Eigen::Isometry3d old_pose = model_pose(model);
  if (!impl_->has_bodies(instance)) {
    instance.set_base(pose);
  } else if (has_anchors || instance.blueprint().is_joined_to_world) {
    // Held by the world: built anew at the new place.
    instance.set_base(pose);
    instance.enter(impl_->shards_[static_cast<std::size_t>(instance.shard)]->world(), impl_->world_->physics);
  } else {
    const Eigen::Isometry3d move = pose * old_pose.inverse();
    auto states = instance.save();
    for (auto& state : states.bodies) {
      state.position = move * state.position;
      state.orientation = (Eigen::Quaterniond(move.linear()) * state.orientation).normalized();
      state.linear.setZero();
      state.angular.setZero();
      state.is_awake = true;
    }
    states.forces.assign(states.forces.size(), {});
    instance.restore(states, impl_->world_->physics.step);
  }
  for (const auto& other : impl_->models_) {
    if (other && impl_->has_bodies(*other)) other->wake();
  }
  if (has_anchors) impl_->refresh_statics();
  impl_->partition();
  return {};
}

base::Result<void> Physics::set_model_twist(ModelId model, const Twist& twist) {
  if (!is_sane(twist.linear, 1000) || !is_sane(twist.angular, 1000)) {
    return base::Error{fmt::format("model {}: velocity must be finite and below 1000 m/s and rad/s", def(model).name)};
  }
  ModelInstance& instance = impl_->at(model);
  if (!impl_->has_bodies(instance)) return base::Error{fmt::format("model {}: is static", def(model).name)};
  const Eigen::Vector3d origin = link_pose(canonical_link(model)).translation();
  instance.stop_rolling();
  instance.wake();
  instance.forces().forget();
  for (std::uint32_t i = 0; i < instance.body_count(); ++i) {
    const dBodyID body = instance.body(i);
    if (body == nullptr) continue;
    const Eigen::Vector3d v = twist.linear + twist.angular.cross(ode::vector(dBodyGetPosition(body)) - origin);
    dBodySetLinearVel(body, v.x(), v.y(), v.z());
    dBodySetAngularVel(body, twist.angular.x(), twist.angular.y(), twist.angular.z());
  }
  return {};
}

base::Result<void> Physics::add_wrench(LinkId link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque) {
  if (!is_sane(force, 1e7) || !is_sane(torque, 1e7)) {
    return base::Error{fmt::format("model {}: force and torque must be finite and below 1e7, got {:g} {:g} {:g} and {:g} {:g} {:g}",
                                   def(link.model).name, force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z())};
  }
  ModelInstance& instance = impl_->at(link.model);
  const dBodyID body = instance.body_count() == 0 ? nullptr : instance.body(instance.blueprint().assembly_of_link[link.link]);
  if (body == nullptr)
    return base::Error{fmt::format("model {}: link {} cannot move", def(link.model).name, def(link.model).links[link.link].name)};
  instance.stop_rolling();
  instance.wake();
  dBodyAddForce(body, force.x(), force.y(), force.z());
  dBodyAddTorque(body, torque.x(), torque.y(), torque.z());
  return {};
}

base::Result<void> Physics::check_effort(JointId joint, double effort) const {
  const JointInstance* instance = impl_->at(joint.model).joint(joint.joint);
  const std::string& name = def(joint.model).joints[joint.joint].name;
  if (!(std::abs(effort) < 1e7))
    return base::Error{
        fmt::format("model {}: the effort of joint {} must be finite and below 1e7, got {:g}", def(joint.model).name, name, effort)};
  if (instance == nullptr || !instance->takes_effort())
    return base::Error{fmt::format("model {}: joint {} neither turns nor slides", def(joint.model).name, name)};
  return {};
}

base::Result<void> Physics::add_effort(JointId joint, double effort) {
  if (const auto good = check_effort(joint, effort); !good) return good;
  ModelInstance& model = impl_->at(joint.model);
  model.stop_rolling();
  model.wake();
  model.joint(joint.joint)->add_effort(0, effort);
  return {};
}

void Physics::set_gravity(ModelId model, bool on) {
  impl_->at(model).stop_rolling();
  impl_->at(model).rolling.reset();
  impl_->at(model).set_gravity(on);
  if (on) impl_->let_roll(impl_->at(model));
}

bool Physics::make_kinematic(ModelId model) {
  impl_->at(model).stop_rolling();
  impl_->at(model).rolling.reset();
  return impl_->at(model).make_kinematic();
}

JointState Physics::joint_state(JointId joint, int axis) const {
  const JointInstance* instance = impl_->at(joint.model).joint(joint.joint);
  return instance == nullptr ? JointState{} : instance->state(axis);
}

void Physics::set_motor(JointId joint, int axis, double velocity, double effort) {
  ModelInstance& model = impl_->at(joint.model);
  JointInstance* instance = model.joint(joint.joint);
  if (instance == nullptr || instance->has_row() || !std::isfinite(velocity) || std::isnan(effort)) return;
  model.set_drive(*instance, axis, velocity, effort);
}

void Physics::set_row(JointId joint, const JointRow& row) {
  ModelInstance& model = impl_->at(joint.model);
  model.stop_rolling();
  model.rolling.reset();
  if (JointInstance* instance = model.joint(joint.joint)) model.set_row(*instance, row);
}

base::Result<void> Physics::attach(LinkId first, LinkId second) {
  const auto name = [&](LinkId link) { return def(link.model).name + "::" + def(link.model).links[link.link].name; };
  if (first.model == second.model) return base::Error{fmt::format("{} and {} are links of one model", name(first), name(second))};
  if (!can_move(first) && !can_move(second)) return base::Error{fmt::format("neither {} nor {} can move", name(first), name(second))};
  if (!can_move(second)) std::swap(first, second);
  if (are_attached(first, second)) return base::Error{fmt::format("{} and {} are attached already", name(first), name(second))};
  ModelInstance &a = impl_->at(first.model), &b = impl_->at(second.model);
  auto weld = std::make_unique<Weld>(a, piece_of(first), b, piece_of(second));
  for (ModelInstance* model : {&a, &b}) {
    model->welds.push_back(weld.get());
    if (!impl_->has_bodies(*model)) continue;
    model->stop_rolling();
    model->wake();
    model->left_neighbourhood = true;
  }
  impl_->welds_.push_back(std::move(weld));
  impl_->partition();
  return {};
}

void Physics::detach(LinkId first, LinkId second) {
  impl_->drop_welds([&](const Weld& weld) { return weld.joins(first.model, piece_of(first), second.model, piece_of(second)); });
}

bool Physics::are_attached(LinkId first, LinkId second) const {
  return std::ranges::any_of(impl_->welds_,
                             [&](const auto& weld) { return weld->joins(first.model, piece_of(first), second.model, piece_of(second)); });
}

void Physics::set_belt(LinkId link, const Belt& belt) {
  if (belt.axis.allFinite() && std::isfinite(belt.speed)) impl_->at(link.model).set_belt(link.link, belt);
}

}  // namespace sim
