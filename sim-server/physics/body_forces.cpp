#include "physics/body_forces.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/joints.h"

namespace sim {
namespace {

constexpr double slowest = 0.01;          // [m/s] of the flow that a wing notices
constexpr double max_damped_share = 0.5;  // of a step's damping: it must not turn the motion round

bool is_carried_by(const FluidDef& fluid, const std::string& model) {
  return fluid.models.empty() || std::find(fluid.models.begin(), fluid.models.end(), model) != fluid.models.end();
}

Eigen::Isometry3d pose_of_body(dBodyID body) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = ode::quaternion(dBodyGetQuaternion(body)).toRotationMatrix();
  pose.translation() = ode::vector(dBodyGetPosition(body));
  return pose;
}

Eigen::Matrix3d crossing(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Velocity of a place that moves with the body.
Eigen::Vector3d velocity_at(dBodyID body, const Eigen::Vector3d& place) {
  return ode::vector(dBodyGetLinearVel(body)) + ode::vector(dBodyGetAngularVel(body)).cross(place - ode::vector(dBodyGetPosition(body)));
}

void push(dBodyID body, const Eigen::Vector3d& place, const Eigen::Vector3d& force, const Eigen::Vector3d& torque) {
  if (!force.allFinite() || !torque.allFinite()) return;
  dBodyAddForceAtPos(body, force.x(), force.y(), force.z(), place.x(), place.y(), place.z());
  dBodyAddTorque(body, torque.x(), torque.y(), torque.z());
}

bool is_awake(dBodyID body) { return body != nullptr && dBodyIsEnabled(body) != 0; }

// The mass of a body about a link's origin, along its axes.
Matrix6 mass_at(const Assembly& assembly, const Eigen::Isometry3d& link_in_body) {
  const Eigen::Matrix3d turn = link_in_body.linear().transpose();
  const Eigen::Matrix3d arm = crossing(-(turn * link_in_body.translation()));  // of the centre of mass
  Matrix6 mass;
  mass.topLeftCorner<3, 3>() = assembly.mass * Eigen::Matrix3d::Identity();
  mass.topRightCorner<3, 3>() = -assembly.mass * arm;
  mass.bottomLeftCorner<3, 3>() = assembly.mass * arm;
  mass.bottomRightCorner<3, 3>() = turn * assembly.inertia * turn.transpose() - assembly.mass * arm * arm;
  return mass;
}

}  // namespace

BodyForces::BodyForces(const Blueprint& blueprint, const PhysicsDef& physics, ShapeStore& shapes, std::vector<std::string>& lost)
    : blueprint_(blueprint) {
  has_wind_ = !physics.wind.isZero() && std::any_of(blueprint.assemblies.begin(), blueprint.assemblies.end(),
                                                    [](const Assembly& assembly) { return assembly.wind_mass > 0; });
  if (physics.fluid && is_carried_by(*physics.fluid, blueprint.model->name)) add_floats(shapes, lost);
  add_waters();
  const auto take = [&](const auto& defs, auto& taken) {
    for (const auto& def : defs) {
      const auto assembly = blueprint.assembly_of_link[def.link];
      if (!blueprint.assemblies[assembly].is_anchored) taken.push_back({assembly, def, blueprint.link_in_body[def.link]});
    }
  };
  take(blueprint.wings, wings_), take(blueprint.airframes, airframes_), take(blueprint.airships, airships_), take(blueprint.hulls, hulls_);
}

void BodyForces::add_floats(ShapeStore& shapes, std::vector<std::string>& lost) {
  const ModelDef& model = *blueprint_.model;
  for (std::uint32_t l = 0; l < model.links.size(); ++l) {
    const auto assembly = blueprint_.assembly_of_link[l];
    if (blueprint_.assemblies[assembly].is_anchored) continue;
    for (const CollisionDef& collision : model.links[l].collisions) {
      auto shape = Displacement::of(collision.geometry, shapes.triangles());
      if (shape) {
        floats_.push_back({assembly, std::move(*shape), blueprint_.link_in_body[l] * collision.pose});
      } else if (std::holds_alternative<MeshShape>(collision.geometry)) {
        lost.push_back(fmt::format("model {}: collision {}::{}: the mesh has no volume; the fluid does not lift it", model.name,
                                   model.links[l].name, collision.name));
      }
    }
  }
}

void BodyForces::add_waters() {
  for (const HydrodynamicsDef& def : blueprint_.hydrodynamics) {
    const auto assembly = blueprint_.assembly_of_link[def.link];
    const Assembly& body = blueprint_.assemblies[assembly];
    if (body.is_anchored) continue;
    Water water{assembly, def, blueprint_.link_in_body[def.link]};
    water.own = mass_at(body, water.in_body);
    water.mass = body.mass;
    water.inertia = (water.in_body.linear().transpose() * body.inertia * water.in_body.linear()).diagonal();
    water.of_both = (water.own - def.added).inverse();
    water.has_added = !def.added.isZero(0) && water.of_both.allFinite();
    waters_.push_back(std::move(water));
  }
  memories_.resize(waters_.size());
}

void BodyForces::apply(const std::vector<ode::Body>& bodies, const std::vector<JointInstance>& joints, const PhysicsDef& physics,
                       const Air& air) {
  for (const Float& one : floats_) {
    if (is_awake(bodies[one.assembly].id())) lift(one, bodies[one.assembly].id(), *physics.fluid, physics.gravity);
  }
  for (std::size_t i = 0; i < waters_.size(); ++i) {
    const dBodyID body = bodies[waters_[i].assembly].id();
    if (is_awake(body)) damp(waters_[i], memories_[i], body, physics.step);
  }
  for (const auto& hull : hulls_) {
    const dBodyID body = bodies[hull.assembly].id();
    if (!is_awake(body)) continue;
    const Eigen::Isometry3d pose = pose_of_body(body) * hull.in_body;
    for (const Eigen::Vector3d& point : hull.def.points) {
      const Eigen::Vector3d place = pose * point;
      push(body, place, {0, 0, lift_on(hull.def, hull.def.level - place.z(), physics.gravity.norm())}, Eigen::Vector3d::Zero());
    }
  }
  fly_all(bodies, joints, air.wind);
  is_blown_ = has_wind_ && !air.is_steady;
  if (has_wind_) blow(bodies, air);
}

void BodyForces::fly_all(const std::vector<ode::Body>& bodies, const std::vector<JointInstance>& joints,
                         const Eigen::Vector3d& wind) const {
  const auto angle_of = [&](std::uint32_t wanted) {
    for (const JointInstance& joint : joints) {
      if (joint.index() == wanted) return joint.state(0).position;
    }
    return 0.0;
  };
  for (const auto& wing : wings_) {
    const dBodyID body = bodies[wing.assembly].id();
    if (is_awake(body)) fly(wing, body, wing.def.control_joint ? angle_of(*wing.def.control_joint) : 0, wind);
  }
  // In the link, at a place in it.
  const auto push_at = [&](dBodyID body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& place, const Eigen::Vector3d& air,
                           const auto& force_by) {
    const Eigen::Matrix3d into = pose.linear().transpose();
    const AirForce force = force_by(Eigen::Vector3d(into * (velocity_at(body, pose * place) - air)),
                                    Eigen::Vector3d(into * ode::vector(dBodyGetAngularVel(body))));
    push(body, pose * place, pose.linear() * force.force, pose.linear() * force.torque);
  };
  for (const auto& one : airframes_) {
    const dBodyID body = bodies[one.assembly].id();
    if (!is_awake(body)) continue;
    std::vector<double> angles;
    for (const auto& surface : one.def.surfaces) angles.push_back(angle_of(surface.joint));
    push_at(body, pose_of_body(body) * one.in_body, one.def.center, wind,
            [&](const auto& velocity, const auto& rate) { return force_on(one.def, velocity, rate, angles); });
  }
  for (const auto& one : airships_) {
    const dBodyID body = bodies[one.assembly].id();
    if (!is_awake(body)) continue;
    push_at(body, pose_of_body(body) * one.in_body, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
            [&](const auto& velocity, const auto& rate) { return force_on(one.def, velocity, rate); });
  }
}

void BodyForces::blow(const std::vector<ode::Body>& bodies, const Air& air) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const dBodyID body = bodies[i].id();
    const double mass = blueprint_.assemblies[i].wind_mass;
    if (mass <= 0 || !is_awake(body)) continue;
    const Eigen::Vector3d force = mass * air.scale * (air.wind - ode::vector(dBodyGetLinearVel(body)));
    dBodyAddForce(body, force.x(), force.y(), force.z());
  }
}

// By the weight of the fluid that it takes the place of, layer by layer, at the middle of that.
void BodyForces::lift(const Float& one, dBodyID body, const FluidDef& fluid, const Eigen::Vector3d& gravity) {
  const Eigen::Isometry3d pose = pose_of_body(body) * one.in_body;
  const Eigen::Vector3d up = pose.linear().row(2);  // in the shape's frame
  double mass = 0, density = fluid.density;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const auto& [height, above] : fluid.changes) {
    const auto part = one.shape.below(up, height - pose.translation().z());
    mass += (density - above) * part.volume;
    moment += (density - above) * part.moment;
    density = above;
  }
  mass += density * one.shape.whole().volume;
  moment += density * one.shape.whole().moment;
  if (!(mass > 0)) return;
  push(body, pose * (moment / mass), -mass * gravity, Eigen::Vector3d::Zero());
}

// In the frame of the link, at its origin, as Fossen has it.
void BodyForces::damp(const Water& water, Memory& memory, dBodyID body, double dt) {
  const HydrodynamicsDef& def = water.def;
  const Eigen::Isometry3d pose = pose_of_body(body) * water.in_body;
  const Eigen::Matrix3d into = pose.linear().transpose();
  Vector6 v;
  v << into * (velocity_at(body, pose.translation()) - def.current), into * ode::vector(dBodyGetAngularVel(body));
  Matrix6 damping = def.linear;
  for (const auto& product : def.quadratic)
    damping(product.to, product.by) += product.value * (product.is_absolute ? std::abs(v[product.with]) : v[product.with]);
  for (int i = 0; i < 6; ++i) damping(i, i) = std::max(damping(i, i), -max_damped_share * (i < 3 ? water.mass : water.inertia[i - 3]) / dt);
  Vector6 effort = damping * v;
  if (water.has_added) effort += drag_along(water, memory, v, dt);
  push(body, pose.translation(), pose.linear() * effort.head<3>(), pose.linear() * effort.tail<3>());
}

// What the water that goes along with the body puts on it.
Vector6 BodyForces::drag_along(const Water& water, Memory& memory, const Vector6& v, double dt) {
  const Matrix6 added = -water.def.added;
  if (memory.has_velocity) {
    const Vector6 acceleration = (v - memory.velocity) / dt;
    memory.debt += dt * (added * acceleration + memory.effort);
    const Vector6 others = water.own * acceleration - memory.effort;
    memory.effort = -(added * water.of_both * others) - water.own * water.of_both * memory.debt / dt;
  }
  memory.velocity = v;
  memory.has_velocity = true;
  Vector6 effort = memory.effort;
  if (!water.def.has_coriolis) return effort;
  const Vector6 momentum = added * v;
  const Eigen::Vector3d along = v.head<3>(), spin = v.tail<3>();
  effort.head<3>() -= spin.cross(momentum.head<3>());
  const Eigen::Vector3d pushed =
      water.def.has_munk ? Eigen::Vector3d(momentum.head<3>()) : Eigen::Vector3d(added.topRightCorner<3, 3>() * spin);
  effort.tail<3>() -= along.cross(pushed) + spin.cross(momentum.tail<3>());
  return effort;
}

void BodyForces::fly(const OnBody<WingDef>& wing, dBodyID body, double control, const Eigen::Vector3d& wind) {
  const WingDef& def = wing.def;
  const Eigen::Isometry3d pose = pose_of_body(body) * wing.in_body;
  const Eigen::Vector3d place = pose * def.center;
  const Eigen::Vector3d flow = velocity_at(body, place) - wind;  // of the wing through the air
  if (flow.norm() <= slowest) return;
  const Eigen::Vector3d forward = pose.linear() * def.forward;
  Eigen::Vector3d upward = pose.linear() * def.upward;
  if (def.is_radial) upward = forward.cross(forward.cross(flow)).normalized();
  const Eigen::Vector3d along_span = forward.cross(upward).normalized();
  const double sine = std::clamp(along_span.dot(flow.normalized()), -1.0, 1.0), sweep = 1 - sine * sine;
  const Eigen::Vector3d across = flow - flow.dot(along_span) * along_span;
  if (across.norm() <= slowest) return;
  const Eigen::Vector3d lifts = along_span.cross(across).normalized();
  double alpha = def.a0 + std::atan2(lifts.dot(forward), lifts.dot(upward));
  while (std::abs(alpha) > std::numbers::pi / 2) alpha -= std::copysign(std::numbers::pi, alpha);
  const double pressure = 0.5 * def.density * across.squaredNorm() * def.area;
  const double within = std::clamp(alpha, -def.stall, def.stall), beyond = alpha - within;
  double lift = (def.lift * within + def.lift_stalled * beyond) * sweep;
  if (beyond > 0) lift = std::max(lift, 0.0);
  if (beyond < 0) lift = std::min(lift, 0.0);
  lift += def.lift_by_joint * control;
  const double drag = std::abs(def.drag * within + def.drag_stalled * beyond) * sweep;
  push(body, place, pressure * (lift * lifts - drag * across.normalized()), Eigen::Vector3d::Zero());
}

void BodyForces::add_to(StateHash& hash) const {
  for (std::size_t i = 0; i < waters_.size(); ++i) {
    if (!waters_[i].has_added) continue;
    for (int k = 0; k < 6; ++k) hash.add_all(memories_[i].velocity[k], memories_[i].effort[k], memories_[i].debt[k]);
  }
}

}  // namespace sim
