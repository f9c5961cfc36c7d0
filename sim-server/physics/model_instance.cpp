#include "physics/model_instance.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "physics/tree_solver.h"

namespace sim {
namespace {

bool has_rotor(const JointDef& joint) {
  return std::any_of(joint.axes.begin(), joint.axes.end(), [](const AxisDef& axis) { return axis.rotor_inertia > 0; });
}

constexpr double fastest = 5000;  // [m/s], [rad/s]: nothing that is simulated sanely gets there

}  // namespace

void ModelInstance::set_belt(std::uint32_t link, const Belt& belt) {
  has_running_belt_ = false;
  bool lets_go = false;
  for (auto& shape : shapes_) {
    if (shape.link.link == link) {
      if (!shape.belt) shape.belt = std::make_unique<Belt>();
      lets_go = lets_go || (belt.is_free && !shape.belt->is_free);
      *shape.belt = belt;
    }
    has_running_belt_ = has_running_belt_ || (shape.belt && shape.belt->speed != 0);
  }
  if ((belt.speed != 0 || lets_go) && !bodies_.empty()) wake();
}

void ModelInstance::place_anchored() {
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    ShapeInstance& shape = shapes_[i];
    if (FrictionFrame* frame = shape.friction_frame.get())
      frame->in_world = base_.linear() * blueprint_->assemblies[frame->assembly].in_model.linear() * frame->direction;
    if (!blueprint_->assemblies[shape.assembly].is_anchored) continue;
    const Eigen::Isometry3d pose = base_ * blueprint_->assemblies[shape.assembly].in_model * shape_in_body_[i];
    if (dGeomGetClass(shape.geom.id()) == dPlaneClass) {
      const auto& plane = std::get<PlaneShape>(blueprint_->model->links[shape.link.link].collisions[shape.collision].geometry);
      const Eigen::Vector3d normal = (pose.linear() * plane.normal).normalized();
      dGeomPlaneSetParams(shape.geom.id(), normal.x(), normal.y(), normal.z(), normal.dot(pose.translation()));
      shape.box = {{-infinite, -infinite, -infinite}, {infinite, infinite, infinite}};
      // Level ground: nothing above it can touch it.
      for (int k = 0; k < 3; ++k) {
        if (normal[k] == 1) shape.box.high[k] = pose.translation()[k];
        if (normal[k] == -1) shape.box.low[k] = pose.translation()[k];
      }
    } else {
      ode::set_pose(shape.geom.id(), pose);
      shape.box = box_of(shape.geom.id());
    }
  }
}

// --- the model

ModelInstance::ModelInstance(ModelId id, std::shared_ptr<const Blueprint> blueprint, const Eigen::Isometry3d& base,
                             const PhysicsDef& physics, ShapeStore& shapes, std::vector<std::string>& lost)
    : id_(id), blueprint_(std::move(blueprint)), base_(base), forces_(*blueprint_, physics, shapes, lost) {
  ode::prepare_thread();
  const auto& joints = blueprint_->model->joints;
  for (std::uint32_t follower = 0; follower < joints.size(); ++follower) {
    if (!joints[follower].mimic) continue;
    for (std::uint32_t leader = 0; leader < joints.size(); ++leader) {
      if (leader != follower && joints[leader].name == joints[follower].mimic->leader && joints[leader].axes.size() == 1)
        mimics_.push_back({follower, leader});
    }
  }
  has_rotors_ = std::any_of(joints.begin(), joints.end(), [](const JointDef& joint) { return has_rotor(joint); });
  for (const Assembly& assembly : blueprint_->assemblies) mass_ += assembly.is_anchored ? 0 : assembly.mass;
  make_shapes(shapes, lost);
  place_anchored();
}

void ModelInstance::set_base(const Eigen::Isometry3d& base) {
  base_ = base;
  place_anchored();
}

int ModelInstance::assembly_of(const std::string& link) const {
  const auto& links = blueprint_->model->links;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i].name == link) return static_cast<int>(blueprint_->assembly_of_link[i]);
  }
  return -1;
}

void ModelInstance::enter(dWorldID world, const PhysicsDef& physics) {
  struct Order {
    std::uint32_t joint;
    int axis;
    double velocity, effort;
  };
  std::vector<Order> orders;  // what the motors do now, they go on with; controllers set theirs before each step
  for (const auto& joint : joints_) {
    for (int i = 0; i < 2 && !joint.has_row(); ++i) {
      if (joint.drive(i).is_set) orders.push_back({joint.index(), i, joint.drive(i).velocity, joint.drive(i).effort});
    }
  }
  joints_.clear();
  has_rows_ = false;
  joint_places_.assign(blueprint_->model->joints.size(), -1);
  for (auto& shape : shapes_) {
    if (!blueprint_->assemblies[shape.assembly].is_anchored) dGeomSetBody(shape.geom.id(), nullptr);
  }
  bodies_.clear();
  for (const Assembly& assembly : blueprint_->assemblies) make_body(world, assembly);
  hang_shapes();
  has_forces_ = !forces_.is_empty();
  forces_.forget();
  for (const auto j : blueprint_->joints) make_joint(world, physics, j);
  tree_ = joint_tree(bodies_, joints_);
  joint_rows_ = std::accumulate(joints_.begin(), joints_.end(), 0U, [](auto sum, const auto& joint) { return sum + joint.rows(); });
  moving_bodies_ =
      static_cast<std::uint32_t>(std::count_if(bodies_.begin(), bodies_.end(), [](const auto& body) { return body.id() != nullptr; }));
  take_initial_positions();
  begin_joints(physics.step);
  for (const auto& order : orders) {
    if (auto* restored = this->joint(order.joint)) set_drive(*restored, order.axis, order.velocity, order.effort);
  }
  left_neighbourhood = may_be_awake = true;
  still_steps_ = slow_steps_ = 0;
  if (rolls()) drop_shapes();
}

void ModelInstance::hang_shapes() {
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const dBodyID body = bodies_[shapes_[i].assembly].id();
    if (body == nullptr) continue;
    dGeomSetBody(shapes_[i].geom.id(), body);
    ode::set_offset(shapes_[i].geom.id(), shape_in_body_[i]);
    find_bodies_of(shapes_[i]);
  }
}

void ModelInstance::drop_shapes() {
  for (auto& shape : shapes_) {
    if (bodies_[shape.assembly].id() != nullptr) dGeomSetBody(shape.geom.id(), nullptr);
  }
}

void ModelInstance::make_body(dWorldID world, const Assembly& assembly) {
  bodies_.emplace_back();
  if (assembly.is_anchored) return;
  bodies_.back() = ode::Body(dBodyCreate(world));
  const dBodyID body = bodies_.back().id();
  const Eigen::Isometry3d pose = base_ * assembly.in_model;
  const Eigen::Quaterniond q(pose.linear());
  const dQuaternion ode_q = {q.w(), q.x(), q.y(), q.z()};
  dBodySetQuaternion(body, ode_q);
  dBodySetPosition(body, pose.translation().x(), pose.translation().y(), pose.translation().z());
  dMass mass;
  const Eigen::Matrix3d& i = assembly.inertia;
  dMassSetZero(&mass);
  dMassSetParameters(&mass, assembly.mass, 0, 0, 0, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2));
  dBodySetMass(body, &mass);
  dBodySetGravityMode(body, assembly.has_gravity && gravity_ ? 1 : 0);
  if (assembly.is_kinematic || is_kinematic_) dBodySetKinematic(body);
  dBodySetLinearDamping(body, std::clamp(assembly.linear_damping, 0.0, 1.0));
  dBodySetAngularDamping(body, std::clamp(assembly.angular_damping, 0.0, 1.0));
  dBodySetLinearDampingThreshold(body, 0);
  dBodySetAngularDampingThreshold(body, 0);
  dBodySetAutoDisableFlag(body, 0);  // lies_still() decides
}

void ModelInstance::make_joint(dWorldID world, const PhysicsDef& physics, std::uint32_t index) {
  const JointDef& def = blueprint_->model->joints[index];
  const int parent = assembly_of(def.parent), child = assembly_of(def.child);
  const auto body_of = [&](int assembly) { return assembly < 0 ? nullptr : bodies_[static_cast<std::size_t>(assembly)].id(); };
  if (body_of(parent) == body_of(child)) return;  // both in the world, or one rigid piece
  JointInstance joint(world, physics, def, index, base_ * def.pose_in_model, body_of(parent), body_of(child));
  joint.parent_assembly = parent;
  joint.child_assembly = child;
  if (def.kind == JointDef::Kind::gearbox) {
    const auto [first, second] = gear_anchors(*blueprint_->model, def);
    joint.set_gear_anchors(base_ * first, base_ * second);
  }
  has_forces_ = has_forces_ || joint.has_forces();
  joint_places_[index] = static_cast<int>(joints_.size());
  joints_.push_back(std::move(joint));
}

void ModelInstance::begin_joints(double dt) {
  const auto& links = blueprint_->model->links;
  const bool is_saved = std::any_of(links.begin(), links.end(), [](const LinkDef& link) { return link.start_pose.has_value(); });
  has_followed_ = false;
  for (auto& joint : joints_) {
    joint.begin(dt, is_saved);
    has_followed_ = has_followed_ || joint.is_followed();
  }
}

void ModelInstance::follow_joints(double dt) {
  if (!has_followed_) return;
  for (auto& joint : joints_) {
    if (joint.is_followed()) joint.follow(dt);
  }
}

// After the joints were made: they count from the places that the file gives.
void ModelInstance::take_initial_positions() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Assembly& assembly = blueprint_->assemblies[i];
    const auto& moved = assembly.moved_at_start;
    const dBodyID body = bodies_[i].id();
    if (body == nullptr) continue;
    if (!moved) continue;
    const Eigen::Isometry3d pose = base_ * *moved * assembly.in_model;
    const Eigen::Quaterniond q(pose.linear());
    const dQuaternion ode_q = {q.w(), q.x(), q.y(), q.z()};
    dBodySetQuaternion(body, ode_q);
    dBodySetPosition(body, pose.translation().x(), pose.translation().y(), pose.translation().z());
  }
}

void ModelInstance::take_initial_velocities() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Assembly& assembly = blueprint_->assemblies[i];
    const dBodyID body = bodies_[i].id();
    if (body == nullptr || (assembly.start_linear.isZero(0) && assembly.start_angular.isZero(0))) continue;
    // The file tells that of the link's origin, ODE keeps that of the centre of mass.
    const Eigen::Vector3d arm = ode::quaternion(dBodyGetQuaternion(body)) * blueprint_->link_in_body[assembly.links.front()].translation();
    const Eigen::Vector3d linear = assembly.start_linear - assembly.start_angular.cross(arm);
    dBodySetLinearVel(body, linear.x(), linear.y(), linear.z());
    dBodySetAngularVel(body, assembly.start_angular.x(), assembly.start_angular.y(), assembly.start_angular.z());
  }
}

void ModelInstance::set_drive(JointInstance& joint, int axis, double velocity, double effort) {
  const auto& drive = joint.drive(axis);
  if (drive.is_set && drive.velocity == velocity && drive.effort == effort) return;
  const bool lets_go = drive.is_set && drive.effort > 0 && effort == 0;  // what it held rolls away
  joint.set_drive(axis, velocity, effort);
  has_forces_ = has_forces_ || joint.has_forces();
  if ((velocity != 0 && effort > 0) || lets_go) wake();
}

void ModelInstance::set_row(JointInstance& joint, const JointRow& row) {
  has_rows_ = has_forces_ = true;
  joint.set_row(row, tree_.is_one);
  if (row.keeps_awake) wake();
}

bool ModelInstance::is_for_tree() const {
  return has_rows_ || has_rotors_ || !mimics_.empty() || tree_.places.size() >= TreeSolver::least_bodies;
}

void ModelInstance::apply_forces(dJointGroupID step_joints, const PhysicsDef& physics, const Air& air) {
  if (!has_forces_) return;
  for (auto& joint : joints_) {
    if (joint.has_forces()) joint.apply(step_joints, physics.step);
  }
  if (!forces_.is_empty()) forces_.apply(bodies_, joints_, physics, air);
}

JointInstance* ModelInstance::joint(std::uint32_t index) {
  const int place = index < joint_places_.size() ? joint_places_[index] : -1;
  return place < 0 ? nullptr : &joints_[static_cast<std::size_t>(place)];
}

std::optional<BodyState> ModelInstance::state(std::size_t assembly) const {
  const dBodyID body = bodies_[assembly].id();
  if (body == nullptr) return std::nullopt;
  return BodyState{ode::vector(dBodyGetPosition(body)), ode::vector(dBodyGetLinearVel(body)), ode::vector(dBodyGetAngularVel(body)),
                   ode::quaternion(dBodyGetQuaternion(body)), dBodyIsEnabled(body) != 0};
}

ModelInstance::State ModelInstance::save() const {
  State now;
  for_each_state([&now](const BodyState& body) { now.bodies.push_back(body); });
  for (const auto& joint : joints_) now.joints.push_back(joint.places());
  now.forces = forces_.memories();
  return now;
}

void ModelInstance::restore(const State& state, double dt) {
  std::size_t i = 0;
  for (const auto& handle : bodies_) {
    const dBodyID body = handle.id();
    if (body == nullptr) continue;
    const BodyState& s = state.bodies[i++];
    const dQuaternion q = {s.orientation.w(), s.orientation.x(), s.orientation.y(), s.orientation.z()};
    dBodySetQuaternion(body, q);
    dBodySetPosition(body, s.position.x(), s.position.y(), s.position.z());
    dBodySetLinearVel(body, s.linear.x(), s.linear.y(), s.linear.z());
    dBodySetAngularVel(body, s.angular.x(), s.angular.y(), s.angular.z());
    s.is_awake ? dBodyEnable(body) : dBodyDisable(body);
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) joints_[j].take(state.joints[j], dt);
  forces_.remember(state.forces);
  left_neighbourhood = may_be_awake = true;
}

bool ModelInstance::is_awake() const {
  for (const auto& body : bodies_) {
    if (body.id() != nullptr && dBodyIsEnabled(body.id()) != 0) return true;
  }
  return false;
}

void ModelInstance::wake() {
  still_steps_ = slow_steps_ = 0;
  if (rolls()) return rolling->wake();
  may_be_awake = true;
  for (const auto& body : bodies_) {
    if (body.id() != nullptr) dBodyEnable(body.id());
  }
}

void ModelInstance::sleep() {
  for (const auto& handle : bodies_) {
    const dBodyID body = handle.id();
    if (body == nullptr || dBodyIsEnabled(body) == 0) continue;
    dBodyDisable(body);
    dBodySetLinearVel(body, 0, 0, 0);
    dBodySetAngularVel(body, 0, 0, 0);
  }
}

bool ModelInstance::lies_still(double dt, bool touches) {
  // [m/s], [rad/s], [s]. What stays below the lower ones for the shorter time is no faster changing its speed than what stays below the
  // higher ones for the longer time: a pendulum that turns does neither.
  constexpr double slow = 0.004, slow_turn = 0.01, slow_time = 0.5;
  constexpr double still = 0.0005, still_turn = 0.001, still_time = 0.1;
  constexpr std::uint32_t least_steps = 10;
  if (!blueprint_->model->allow_auto_disable || (forces_.carries() && !touches) || forces_.is_blown() || lies_on_belt) return false;
  double speed = 0, turn = 0;
  for (const auto& handle : bodies_) {
    if (handle.id() == nullptr) continue;
    speed = std::max(speed, ode::vector(dBodyGetLinearVel(handle.id())).squaredNorm());
    turn = std::max(turn, ode::vector(dBodyGetAngularVel(handle.id())).squaredNorm());
  }
  slow_steps_ = speed < slow * slow && turn < slow_turn * slow_turn ? slow_steps_ + 1 : 0;
  still_steps_ = speed < still * still && turn < still_turn * still_turn ? still_steps_ + 1 : 0;
  const auto lasts = [&](std::uint32_t steps, double time) { return steps >= least_steps && steps * dt >= time; };
  return lasts(slow_steps_, slow_time) || (touches && lasts(still_steps_, still_time) && !has_moving_drive());
}

Eigen::Isometry3d ModelInstance::assembly_pose(std::uint32_t assembly) const {
  const dBodyID body = bodies_.empty() ? nullptr : bodies_[assembly].id();
  if (body == nullptr) return base_ * blueprint_->assemblies[assembly].in_model;
  Eigen::Isometry3d pose;
  pose.linear() = ode::quaternion(dBodyGetQuaternion(body)).toRotationMatrix();
  pose.translation() = ode::vector(dBodyGetPosition(body));
  pose.makeAffine();
  return pose;
}

double ModelInstance::fastest_body() const {
  double square = 0;
  for (const auto& body : bodies_) {
    if (body.id() != nullptr) square = std::max(square, ode::vector(dBodyGetLinearVel(body.id())).squaredNorm());
  }
  return std::sqrt(square);
}

const Aabb& ModelInstance::update_boxes() {
  if (rolls()) return moving_box_;
  moving_box_ = Aabb();
  for (auto& shape : shapes_) {
    if (bodies_[shape.assembly].id() == nullptr) continue;
    shape.box = box_of(shape.geom.id());
    moving_box_.extend(shape.box);
  }
  return moving_box_;
}

void ModelInstance::set_gravity(bool on) {
  gravity_ = on;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].id() != nullptr) dBodySetGravityMode(bodies_[i].id(), on && blueprint_->assemblies[i].has_gravity ? 1 : 0);
  }
}

bool ModelInstance::make_kinematic() {
  if (!joints_.empty()) return false;
  is_kinematic_ = true;
  for (const auto& body : bodies_) {
    if (body.id() != nullptr) dBodySetKinematic(body.id());
  }
  return true;
}

Energy ModelInstance::energy(const Eigen::Vector3d& gravity) const {
  Energy energy;
  for (const auto& handle : bodies_) {
    const dBodyID body = handle.id();
    if (body == nullptr) continue;
    dMass mass;
    dBodyGetMass(body, &mass);
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> inertia(mass.I);
    const Eigen::Vector3d turn = ode::quaternion(dBodyGetQuaternion(body)).conjugate() * ode::vector(dBodyGetAngularVel(body));
    energy.motion += 0.5 * (mass.mass * ode::vector(dBodyGetLinearVel(body)).squaredNorm() + turn.dot(inertia.leftCols<3>() * turn));
    if (dBodyGetGravityMode(body) != 0) energy.height -= mass.mass * gravity.dot(ode::vector(dBodyGetPosition(body)));
  }
  for (auto joint = joints_.begin(); has_rotors_ && joint != joints_.end(); ++joint) {
    if (!has_rotor(joint->def())) continue;
    const double rate = joint->state(0).velocity;
    energy.motion += 0.5 * joint->def().axes[0].rotor_inertia * rate * rate;
  }
  return energy;
}

bool ModelInstance::is_driven() const {
  const auto is_kinematic = [](const ode::Body& body) { return body.id() != nullptr && dBodyIsKinematic(body.id()) != 0; };
  return std::any_of(bodies_.begin(), bodies_.end(), is_kinematic) || has_moving_drive();
}

bool ModelInstance::has_stand_ins() const {
  return std::any_of(joints_.begin(), joints_.end(), [](const JointInstance& joint) { return joint.has_stand_in(); });
}

bool ModelInstance::has_moving_drive() const {
  return has_running_belt_ || std::any_of(joints_.begin(), joints_.end(), [](const JointInstance& joint) {
           return (joint.drive(0).velocity != 0 && joint.drive(0).effort > 0) ||
                  (joint.drive(1).velocity != 0 && joint.drive(1).effort > 0);
         });
}

void ModelInstance::slow_down(double factor) {
  for (const auto& handle : bodies_) {
    const dBodyID body = handle.id();
    if (body == nullptr) continue;
    const dReal *v = dBodyGetLinearVel(body), *w = dBodyGetAngularVel(body);
    dBodySetLinearVel(body, factor * v[0], factor * v[1], factor * v[2]);
    dBodySetAngularVel(body, factor * w[0], factor * w[1], factor * w[2]);
  }
}

bool ModelInstance::is_sane() const {
  for (const auto& body : bodies_) {
    if (body.id() == nullptr) continue;
    const dReal *p = dBodyGetPosition(body.id()), *v = dBodyGetLinearVel(body.id()), *w = dBodyGetAngularVel(body.id());
    double worst = 0;
    for (int k = 0; k < 3; ++k) {
      // Comparisons are written so that NaN fails them.
      if (!(std::abs(p[k]) < 1e9)) return false;
      worst = std::max({worst, std::abs(v[k]), std::abs(w[k])});
      if (!(std::abs(v[k]) < fastest) || !(std::abs(w[k]) < fastest)) return false;
    }
    if (!std::isfinite(dBodyGetQuaternion(body.id())[0])) return false;
  }
  return true;
}

}  // namespace sim
