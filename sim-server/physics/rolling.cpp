#include "physics/rolling.h"

#include <algorithm>
#include <cmath>

#include "physics/contact_surface.h"
#include "physics/model_instance.h"

namespace sim {
namespace {

constexpr double time_alone = 0.5;       // [s]
constexpr double level_slope = 1e-6;     // sine of the ground's slope
constexpr double level_axle = 0.02;      // of an axle's
constexpr double sinking = 2e-3;         // [m/s] up or down of a body that has settled
constexpr double nodding = 1e-2;         // [rad/s] about horizontal axes
constexpr double sliding = 2e-3;         // [m/s] of a wheel that rolls, at its contact
constexpr double uneven = 0.05;          // share by which a wheel's inertia may differ about its other axes
constexpr double off_axle = 1e-3;        // [m] of its middle and its centre of mass
constexpr double least_distance = 0.02;  // [m] to what is near
constexpr double braking = 4;            // [m/s^2] of what has to stop
constexpr double furthest = 1e7;         // [m] from the world's origin
constexpr double longest_step = 0.01;    // [s]; ODE and the rolling step are 5 mm apart at 0.02

const Eigen::Vector3d world_up(0, 0, 1);

Eigen::Quaterniond turn_about(const Eigen::Vector3d& axis, double cosine, double sine) {
  return {cosine, sine * axis.x(), sine * axis.y(), sine * axis.z()};
}

// As ODE turns a body in a step: by twice the arc tangent of half the rate times the step.
void turn_on(double rate, double dt, double& cosine, double& sine) {
  const double t = rate * dt / 2, c = cosine - sine * t, s = sine + cosine * t, norm = std::sqrt(c * c + s * s);
  cosine = c / norm, sine = s / norm;
}

void put(dBodyID body, const Eigen::Vector3d& place, const Eigen::Quaterniond& turn, const Eigen::Vector3d& linear,
         const Eigen::Vector3d& angular) {
  const dQuaternion q = {turn.w(), turn.x(), turn.y(), turn.z()};
  dBodySetQuaternion(body, q);
  dBodySetPosition(body, place.x(), place.y(), place.z());
  dBodySetLinearVel(body, linear.x(), linear.y(), linear.z());
  dBodySetAngularVel(body, angular.x(), angular.y(), angular.z());
}

// Speed of a wheel where it touches, below its middle, at a height.
double sliding_of(dBodyID wheel, double height) {
  const dReal *v = dBodyGetLinearVel(wheel), *w = dBodyGetAngularVel(wheel), down = height - dBodyGetPosition(wheel)[2];
  return std::hypot(v[0] + w[1] * down, v[1] - w[0] * down);
}

Eigen::Matrix3d own_inertia(dBodyID body) {
  dMass mass;
  dBodyGetMass(body, &mass);
  const Eigen::Matrix3d turn = ode::quaternion(dBodyGetQuaternion(body)).toRotationMatrix();
  return turn * Eigen::Map<const Eigen::Matrix<dReal, 3, 4, Eigen::RowMajor>>(mass.I).leftCols<3>() * turn.transpose();
}

bool is_ball(const JointInstance& joint) { return joint.def().kind == JointDef::Kind::ball; }

bool is_plain(const JointInstance& joint) {
  if (joint.has_row() || joint.has_coupling() || joint.is_followed()) return false;
  if (joint.def().provide_feedback || !joint.def().sensors.empty()) return false;
  if (is_ball(joint)) return true;
  const auto kind = joint.def().kind;
  if ((kind != JointDef::Kind::revolute && kind != JointDef::Kind::continuous) || joint.axis_count() != 1) return false;
  const AxisDef& axis = joint.def().axes[0];
  return axis.spring_stiffness == 0;
}

bool is_free(const Assembly& assembly) {
  return !assembly.is_anchored && !assembly.is_kinematic && assembly.has_gravity && assembly.linear_damping == 0 &&
         assembly.angular_damping == 0;
}

const ShapeInstance* shape_of(const std::vector<ShapeInstance>& shapes, LinkId link, std::uint32_t collision) {
  const auto at = std::ranges::find_if(shapes, [&](const ShapeInstance& s) { return s.link == link && s.collision == collision; });
  return at == shapes.end() ? nullptr : &*at;
}

// The shape turns about the axle and stays as it is.
bool is_round_about(const ShapeInstance& shape, const Eigen::Vector3d& place, const Eigen::Vector3d& axle) {
  const int kind = dGeomGetClass(shape.geom.id());
  if (kind != dSphereClass && kind != dCylinderClass) return false;
  const dReal* r = dGeomGetRotation(shape.geom.id());
  const Eigen::Vector3d middle = ode::vector(dGeomGetPosition(shape.geom.id()));
  return axle.cross(middle - place).norm() < off_axle &&
         (kind == dSphereClass || axle.cross(Eigen::Vector3d(r[2], r[6], r[10])).norm() < level_axle);
}

bool is_level_ground(const ShapeInstance& shape) {
  const int kind = dGeomGetClass(shape.geom.id());
  if (kind == dPlaneClass) {
    dVector4 plane;
    dGeomPlaneGetParams(shape.geom.id(), plane);
    return plane[2] > 0 && std::abs(plane[0]) < level_slope && std::abs(plane[1]) < level_slope;
  }
  const dReal* r = dGeomGetRotation(shape.geom.id());
  return kind == dBoxClass && std::abs(r[8]) < level_slope && std::abs(r[9]) < level_slope && r[10] > 0;
}

}  // namespace

std::unique_ptr<Rolling> Rolling::of(const ModelInstance& model, const PhysicsDef& physics) {
  const auto& g = physics.gravity;
  if (physics.step > longest_step) return nullptr;
  if (g.x() != 0 || g.y() != 0 || !(g.z() < 0) || model.joints().size() < 2 || model.body_count() != model.joints().size() + 1)
    return nullptr;
  if (!model.forces().is_empty() || !model.mimics().empty()) return nullptr;
  if (!std::ranges::all_of(model.blueprint().assemblies, is_free) || !std::ranges::all_of(model.joints(), is_plain)) return nullptr;
  const ModelDef& def = *model.blueprint().model;
  if (def.self_collide || std::ranges::any_of(def.links, [](const LinkDef& link) { return link.self_collide; })) return nullptr;
  std::unique_ptr<Rolling> rolling(new Rolling(physics));
  return rolling->find_wheels(model) ? std::move(rolling) : nullptr;
}

bool Rolling::find_wheels(const ModelInstance& model) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < model.joints().size(); ++i) {
    const JointInstance& joint = model.joints()[i];
    if (joint.parent_assembly < 0 || joint.child_assembly < 0) return false;
    if (i > 0 && static_cast<std::uint32_t>(joint.parent_assembly) != body_) return false;
    body_ = static_cast<std::uint32_t>(joint.parent_assembly);
    if (is_ball(joint)) {
      if (!add_ball(model, i)) return false;
      continue;
    }
    if (count == 2) return false;
    Wheel& wheel = wheels_[count++];
    wheel.joint = i;
    wheel.assembly = static_cast<std::uint32_t>(joint.child_assembly);
    const AxisDef& axis = joint.def().axes[0];
    wheel.fastest = axis.velocity > 0 ? axis.velocity : infinite;  // files of wheels say 0 where they mean none
    wheel.friction = axis.friction, wheel.damping = axis.damping;
    wheel.axle = joint.seat_on_parent().axis.normalized();
  }
  if (count != 2 || wheels_[0].axle.cross(wheels_[1].axle).norm() > level_axle) return false;
  return is_round(model, wheels_[0]) && is_round(model, wheels_[1]);
}

// One ball about the place of the joint.
bool Rolling::add_ball(const ModelInstance& model, std::size_t joint) {
  Ball ball;
  ball.joint = joint;
  ball.assembly = static_cast<std::uint32_t>(model.joints()[joint].child_assembly);
  const dBodyID body = model.body(body_);
  const Eigen::Vector3d place =
      ode::vector(dBodyGetPosition(body)) + ode::quaternion(dBodyGetQuaternion(body)) * model.joints()[joint].seat_on_parent().place;
  if ((ode::vector(dBodyGetPosition(model.body(ball.assembly))) - place).norm() > off_axle) return false;
  for (const ShapeInstance& shape : model.shapes()) {
    if (shape.assembly != ball.assembly) continue;
    if (ball.radius > 0 || dGeomGetClass(shape.geom.id()) != dSphereClass) return false;
    if ((ode::vector(dGeomGetPosition(shape.geom.id())) - place).norm() > off_axle) return false;
    ball.radius = dGeomSphereGetRadius(shape.geom.id());
  }
  if (!(ball.radius > 0)) return false;
  balls_.push_back(ball);
  return true;
}

bool Rolling::is_round(const ModelInstance& model, const Wheel& wheel) const {
  const dBodyID body = model.body(body_), turning = model.body(wheel.assembly);
  const Eigen::Quaterniond turn = ode::quaternion(dBodyGetQuaternion(body));
  const Eigen::Vector3d axle = turn * wheel.axle;
  const Eigen::Vector3d place = ode::vector(dBodyGetPosition(body)) + turn * model.joints()[wheel.joint].seat_on_parent().place;
  if (axle.cross(ode::vector(dBodyGetPosition(turning)) - place).norm() > off_axle) return false;
  const Eigen::Matrix3d inertia = own_inertia(turning);
  const Eigen::Vector3d first = axle.unitOrthogonal(), second = axle.cross(first);
  const double a = first.dot(inertia * first), b = second.dot(inertia * second);
  if (std::abs(a - b) > uneven * std::max(a, b)) return false;
  return std::ranges::all_of(model.shapes(), [&](const ShapeInstance& shape) {
    return shape.assembly != wheel.assembly || (is_round_about(shape, place, axle) && !shape.slip);
  });
}

double Rolling::reach(double speed, double dt) { return least_distance + speed * dt + speed * speed / (2 * braking); }

bool Rolling::is_settled(const ModelInstance& model) const {
  const dReal *v = dBodyGetLinearVel(model.body(body_)), *w = dBodyGetAngularVel(model.body(body_));
  return std::abs(v[2]) < sinking && std::abs(w[0]) < nodding && std::abs(w[1]) < nodding && model.welds.empty();
}

const ShapeInstance* Rolling::ground_of(const ModelInstance& model, const Statics& statics) const {
  if (model.contacts.empty()) return nullptr;
  const Contact& first = model.contacts.front();
  const auto at = std::ranges::find_if(model.near_statics, [&](std::uint32_t s) {
    return statics[s]->link == first.other && statics[s]->collision == first.other_collision;
  });
  if (at == model.near_statics.end() || !is_level_ground(*statics[*at]) || statics[*at]->belt) return nullptr;
  std::array<int, 2> counts{0, 0};
  for (const Contact& contact : model.contacts) {
    if (contact.other != first.other || contact.other_collision != first.other_collision || !(contact.normal.z() > 1 - level_slope))
      return nullptr;
    for (std::size_t i = 0; i < 2; ++i) {
      if (model.blueprint().assembly_of_link[contact.link.link] != wheels_[i].assembly) continue;
      ++counts[i];
      if (sliding_of(model.body(wheels_[i].assembly), contact.position.z()) > sliding) return nullptr;
    }
  }
  return counts[0] == 1 && counts[1] == 1 ? statics[*at] : nullptr;
}

void Rolling::watch(ModelInstance& model, const Statics& statics) {
  const ShapeInstance* ground = is_settled(model) ? ground_of(model, statics) : nullptr;
  if (ground == nullptr || ground != ground_) ready_steps_ = 0;
  ground_ = ground;
  if (ground == nullptr) return;
  place_ = ode::vector(dBodyGetPosition(model.body(body_)));
  if (ready_steps_ == 0) measure(model);
  speed_ = model.fastest_body() + std::abs(dBodyGetAngularVel(model.body(body_))[2]) * radius_;
  ready_steps_ = is_alone(model, statics) ? ready_steps_ + 1 : 0;
  const bool falls_asleep = !model.is_awake();
  if (ready_steps_ == 0 || (ready_steps_ * dt_ < time_alone && !falls_asleep)) return;
  if (auto motion = motion_of(model)) start(model, std::move(*motion));
  is_asleep_ = falls_asleep && is_rolling();
  ready_steps_ = 0;
}

RollingMass Rolling::mass_of(const ModelInstance& model) const {
  RollingMass sum;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (std::uint32_t i = 0; i < model.body_count(); ++i) {
    middle += model.blueprint().assemblies[i].mass * ode::vector(dBodyGetPosition(model.body(i)));
    sum.mass += model.blueprint().assemblies[i].mass;
  }
  middle /= sum.mass;
  for (std::uint32_t i = 0; i < model.body_count(); ++i) {
    const Eigen::Vector3d away = ode::vector(dBodyGetPosition(model.body(i))) - middle;
    sum.yaw_inertia += own_inertia(model.body(i))(2, 2) + model.blueprint().assemblies[i].mass * away.head<2>().squaredNorm();
  }
  const Eigen::Vector3d at =
      middle - (ode::vector(dBodyGetPosition(model.body(body_))) + ode::quaternion(dBodyGetQuaternion(model.body(body_))) * origin_);
  sum.x = at.dot(forward_), sum.y = at.dot(world_up.cross(forward_)), sum.height = at.z();
  return sum;
}

// Where the contacts of the last step are in the body: ODE found them before it moved the body.
void Rolling::find_feet(const ModelInstance& model) {
  const dBodyID body = model.body(body_);
  place_ = ode::vector(dBodyGetPosition(body));
  start_ = ode::quaternion(dBodyGetQuaternion(body));
  double cosine = 1, sine = 0;
  turn_on(-dBodyGetAngularVel(body)[2], dt_, cosine, sine);
  const Eigen::Quaterniond before = turn_about(world_up, cosine, sine) * start_;
  const Eigen::Vector3d place_before = place_ - dt_ * ode::vector(dBodyGetLinearVel(body));
  feet_.clear();
  std::size_t slides = 2;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Contact& contact : model.contacts) {
    const auto wheel = std::ranges::find(wheels_, model.blueprint().assembly_of_link[contact.link.link], &Wheel::assembly);
    const std::size_t number = wheel == wheels_.end() ? slides++ : static_cast<std::size_t>(wheel - wheels_.begin());
    feet_.push_back({before.conjugate() * (contact.position - place_before), number});
    if (wheel != wheels_.end()) sum += feet_.back().place;
  }
  origin_ = sum / 2;
}

// What ODE has of it: the frame on the ground, and what it stands on.
std::optional<RollingMotion> Rolling::motion_of(const ModelInstance& model) {
  find_feet(model);
  Eigen::Vector3d axle = start_ * wheels_[0].axle;
  if (std::abs(axle.z()) > level_axle) return std::nullopt;
  axle.z() = 0;
  forward_ = axle.normalized().cross(world_up);
  const Eigen::Vector3d left = world_up.cross(forward_);
  std::array<RollingWheel, 2> wheels;
  std::vector<RollingSlide> slides;
  for (std::size_t c = 0; c < feet_.size(); ++c) {
    const auto friction = friction_of(model, model.contacts[c]);
    if (!friction) return std::nullopt;
    const Eigen::Vector3d place = place_ + start_ * feet_[c].place, at = start_ * (feet_[c].place - origin_);
    if (feet_[c].contact >= 2) {
      slides.push_back({at.dot(forward_), at.dot(left), *friction, 0});
      const auto ball = std::ranges::find(balls_, model.blueprint().assembly_of_link[model.contacts[c].link.link], &Ball::assembly);
      if (ball == balls_.end()) continue;
      ball->friction = *friction;
      const double inertia = own_inertia(model.body(ball->assembly)).trace() / 3;
      if (*friction > 0) slides.back().friction = 0, slides.back().ball = inertia / (ball->radius * ball->radius);
      continue;
    }
    const Wheel& wheel = wheels_[feet_[c].contact];
    const dBodyID turning = model.body(wheel.assembly);
    const Eigen::Vector3d about = start_ * wheel.axle, arm = place - ode::vector(dBodyGetPosition(turning));
    const double inertia = about.dot(own_inertia(turning) * about);
    // Without a drive ODE has the damping in a motor of its own, and a stronger one is cut there.
    const bool is_damped = wheel.damping > 0, is_driven = model.joints()[wheel.joint].drive(0).is_set;
    if (is_damped && (!is_driven || wheel.damping * dt_ > 0.4 * inertia)) return std::nullopt;
    wheels[feet_[c].contact] = {at.dot(left), -about.cross(arm).dot(forward_), inertia, *friction, wheel.damping};
  }
  return RollingMotion::of(mass_of(model), wheels, std::move(slides), gravity_);
}

// Nothing where the contact is none that RollingMotion knows.
std::optional<double> Rolling::friction_of(const ModelInstance& model, const Contact& contact) const {
  const ShapeInstance* shape = shape_of(model.shapes(), contact.link, contact.collision);
  if (shape == nullptr || shape->belt || shape->slip) return std::nullopt;
  if (shape->surface->collide_without_contact || ground_->surface->collide_without_contact) return std::nullopt;
  const dSurfaceParameters surface = combine(*shape->surface, *ground_->surface, dt_);
  const double friction = std::min({surface.mu, surface.mu2, best_grip});
  const bool slips = (surface.mode & (dContactSlip1 | dContactSlip2)) != 0 && friction > 0;
  return slips || (surface.mode & dContactBounce) != 0 ? std::nullopt : std::optional(friction);
}

void Rolling::start(ModelInstance& model, RollingMotion motion) {
  motion_ = std::move(motion);
  std::array<double, 2> rates{0, 0};
  for (std::size_t i = 0; i < 2; ++i) {
    Wheel& wheel = wheels_[i];
    const dBodyID turning = model.body(wheel.assembly);
    wheel.center = start_.conjugate() * (ode::vector(dBodyGetPosition(turning)) - place_);
    wheel.start = start_.conjugate() * ode::quaternion(dBodyGetQuaternion(turning));
    wheel.cosine = 1, wheel.sine = 0;
    rates[i] = model.joints()[wheel.joint].state(0).velocity;
  }
  for (Ball& ball : balls_) {
    const dBodyID turning = model.body(ball.assembly);
    ball.center = start_.conjugate() * (ode::vector(dBodyGetPosition(turning)) - place_);
    ball.turn = ode::quaternion(dBodyGetQuaternion(turning));
    ball.spin = ode::vector(dBodyGetAngularVel(turning));
  }
  cosine_ = 1, sine_ = 0;
  is_asleep_ = false;
  motion_->start(rates);
  set_box(model);
  for (std::uint32_t i = 0; i < model.body_count(); ++i) dBodyDisable(model.body(i));
  model.drop_shapes();
  model.may_be_awake = false;
}

void Rolling::measure(const ModelInstance& model) {
  const Aabb& box = model.moving_box();
  low_ = box.low.z(), high_ = box.high.z();
  double square = 0;
  const auto cover = [&](const Eigen::Vector3d& point) { square = std::max(square, (point - place_).head<2>().squaredNorm()); };
  for (const ShapeInstance& shape : model.shapes()) {
    const bool is_box = dGeomGetClass(shape.geom.id()) == dBoxClass;
    dVector3 sides;
    if (is_box) dGeomBoxGetLengths(shape.geom.id(), sides);
    const dReal* r = dGeomGetRotation(shape.geom.id());
    const Eigen::Vector3d middle = is_box ? ode::vector(dGeomGetPosition(shape.geom.id())) : ((shape.box.low + shape.box.high) / 2).eval();
    const Eigen::Vector3d half = is_box ? (ode::vector(sides) / 2).eval() : ((shape.box.high - shape.box.low) / 2).eval();
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d at((corner & 1) != 0 ? half.x() : -half.x(), (corner & 2) != 0 ? half.y() : -half.y(),
                               (corner & 4) != 0 ? half.z() : -half.z());
      cover(middle + (is_box ? (Eigen::Map<const Eigen::Matrix<dReal, 3, 4, Eigen::RowMajor>>(r).leftCols<3>() * at).eval() : at));
    }
  }
  radius_ = std::sqrt(square);
}

void Rolling::set_box(ModelInstance& model) const {
  Aabb box;
  box.low = {place_.x() - radius_, place_.y() - radius_, low_};
  box.high = {place_.x() + radius_, place_.y() + radius_, high_};
  model.set_moving_box(box);
}

bool Rolling::is_on_ground(double reach) const {
  if (dGeomGetClass(ground_->geom.id()) == dPlaneClass) return true;
  dVector3 sides, at;
  dGeomBoxGetLengths(ground_->geom.id(), sides);
  dGeomGetPosRelPoint(ground_->geom.id(), place_.x(), place_.y(), place_.z(), at);
  return std::abs(at[0]) + radius_ + reach < sides[0] / 2 && std::abs(at[1]) + radius_ + reach < sides[1] / 2;
}

bool Rolling::is_alone(const ModelInstance& model, const Statics& statics) const {
  constexpr double above = 1e-3;  // [m] from which on something is on the ground, not part of it
  const double own = reach(speed_, dt_);
  const auto is_near = [&](const Aabb& box, double distance) {
    if (box.high.z() < low_ + above || box.low.z() > high_ + distance) return false;
    const double x = std::max({box.low.x() - place_.x(), place_.x() - box.high.x(), 0.0});
    const double y = std::max({box.low.y() - place_.y(), place_.y() - box.high.y(), 0.0});
    return x * x + y * y < (radius_ + distance) * (radius_ + distance);
  };
  for (const std::uint32_t s : model.near_statics) {
    if (statics[s] != ground_ && is_near(statics[s]->box, own)) return false;
  }
  for (const ModelInstance* other : model.neighbours) {
    if (is_near(other->moving_box(), own + reach(other->fastest_body(), dt_))) return false;
  }
  return !ground_->belt && is_on_ground(own);
}

bool Rolling::step(ModelInstance& model) {
  std::array<RollingMotor, 2> motors;
  for (std::size_t i = 0; i < 2; ++i) {
    const Wheel& wheel = wheels_[i];
    const auto& drive = model.joints()[wheel.joint].drive(0);
    motors[i] = {0, wheel.friction};
    if (drive.effort > 0) motors[i] = {std::clamp(drive.velocity, -wheel.fastest, wheel.fastest), drive.effort};
  }
  if (!motion_->step(motors, dt_) || !(place_.head<2>().cwiseAbs().maxCoeff() < furthest)) return false;
  move(model);
  if (model.lies_still(dt_, true)) {
    motion_->stand();
    for (Ball& ball : balls_) ball.spin.setZero();
    is_asleep_ = true;
    for (std::uint32_t i = 0; i < model.body_count(); ++i) {
      dBodySetLinearVel(model.body(i), 0, 0, 0);
      dBodySetAngularVel(model.body(i), 0, 0, 0);
    }
  }
  return true;
}

// Along the direction in the middle of the step. In ODE wheels touch without sliding across where the robot looks before the step; but
// their axles lean while they turn and roll, and the joints that put this right move the body by the other half.
void Rolling::move(ModelInstance& model) {
  const auto& speeds = motion_->speeds();
  const Eigen::Vector3d spin(0, 0, speeds.yaw);
  const Eigen::Quaterniond before = turn_about(world_up, cosine_, sine_) * start_;
  double cosine = cosine_, sine = sine_;
  turn_on(speeds.yaw, dt_ / 2, cosine, sine);
  const Eigen::Quaterniond turn = turn_about(world_up, cosine, sine), middle = turn * start_;
  const Eigen::Vector3d linear = speeds.forward * (turn * forward_) - spin.cross(middle * origin_);
  std::array<Eigen::Vector3d, 2> wheel_linear;
  for (std::size_t i = 0; i < 2; ++i) {
    wheel_linear[i] = linear + spin.cross(middle * wheels_[i].center);
    turn_on(speeds.wheels[i], dt_, wheels_[i].cosine, wheels_[i].sine);
  }
  set_contacts(model, before);
  place_.x() += dt_ * linear.x(), place_.y() += dt_ * linear.y();
  turn_on(speeds.yaw, dt_, cosine_, sine_);
  const Eigen::Quaterniond now = turn_about(world_up, cosine_, sine_) * start_;
  put(model.body(body_), place_, now, {linear.x(), linear.y(), 0}, spin);
  for (std::size_t i = 0; i < 2; ++i) {
    const Wheel& wheel = wheels_[i];
    put(model.body(wheel.assembly), place_ + now * wheel.center, now * turn_about(wheel.axle, wheel.cosine, wheel.sine) * wheel.start,
        wheel_linear[i], spin + now * (speeds.wheels[i] * wheel.axle));
  }
  move_balls(model, linear, spin, middle, now);
  speed_ = std::abs(speeds.forward) + std::abs(speeds.yaw) * radius_;
  set_box(model);
}

void Rolling::move_balls(const ModelInstance& model, const Eigen::Vector3d& linear, const Eigen::Vector3d& spin,
                         const Eigen::Quaterniond& middle, const Eigen::Quaterniond& now) {
  for (Ball& ball : balls_) {
    const Eigen::Vector3d velocity = linear + spin.cross(middle * ball.center);
    if (ball.friction > 0) ball.spin = Eigen::Vector3d(-velocity.y() / ball.radius, velocity.x() / ball.radius, ball.spin.z());
    const Eigen::Vector3d half = dt_ / 2 * ball.spin;
    const Eigen::Quaterniond change = Eigen::Quaterniond(0, half.x(), half.y(), half.z()) * ball.turn;
    ball.turn.coeffs() += change.coeffs();
    ball.turn.normalize();
    put(model.body(ball.assembly), place_ + now * ball.center, ball.turn, velocity, ball.spin);
  }
}

void Rolling::set_contacts(ModelInstance& model, const Eigen::Quaterniond& turn) const {
  for (std::size_t c = 0; c < feet_.size(); ++c) {
    Contact& contact = model.contacts[c];
    contact.position = place_ + turn * feet_[c].place;
    if (!model.records_forces) continue;
    const auto& force = motion_->force(feet_[c].contact);
    const Eigen::Vector3d ahead = turn_about(world_up, cosine_, sine_) * forward_;
    contact.force = force[0] * ahead + force[1] * world_up.cross(ahead) + force[2] * world_up;
  }
  model.contacts_so_far += feet_.size();
}

void Rolling::stop(ModelInstance& model) {
  ready_steps_ = 0;
  ground_ = nullptr;
  if (!motion_) return;
  motion_.reset();
  for (std::uint32_t i = 0; i < model.body_count() && !is_asleep_; ++i) dBodyEnable(model.body(i));
  model.hang_shapes();
  model.may_be_awake = !is_asleep_;
  is_asleep_ = false;
  model.update_boxes();
}

void Rolling::add_to(StateHash& hash) const {
  hash.add_all(std::uint64_t{ready_steps_}, std::uint64_t{is_rolling()}, std::uint64_t{is_asleep_});
  if (motion_) hash.add_all(cosine_, sine_, motion_->speeds().wheels[0], motion_->speeds().wheels[1]);
}

}  // namespace sim
