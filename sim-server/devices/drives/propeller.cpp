#include "devices/drives/propeller.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "world/body_force_defs.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

constexpr double motor_effort = 1e6;  // [N m] of a joint that turns as told
constexpr double settled = 0.1;       // [rad/s] that the controller of a thruster leaves
constexpr double max_push = 1e6;      // [N]: nothing sane pushes more

double fourth_power(double x) { return x * x * x * x; }

std::string about_propeller(const PluginDef& plugin) { return plugin.source + ": plugin " + base::in_quotes(plugin.name) + ": "; }

Propeller::Setup thruster_of(const PluginDef& plugin, std::vector<std::string>& left_out) {
  const ParameterNode& p = plugin.parameters;
  Propeller::Setup setup;
  setup.diameter = std::max(p.number_of({"propeller_diameter"}).value_or(0.02), 1e-6);
  setup.scale = p.number_of({"fluid_density"}).value_or(1000) * fourth_power(setup.diameter);
  const auto coefficient = p.number_of({"thrust_coefficient"});
  setup.alpha_1 = p.number_of({"alpha_1"}), setup.alpha_2 = p.number_of({"alpha_2"});
  if (coefficient || (!setup.alpha_1 && !setup.alpha_2)) {
    setup.alpha_1.reset(), setup.alpha_2.reset();
  } else {
    setup.alpha_1 = setup.alpha_1.value_or(1), setup.alpha_2 = setup.alpha_2.value_or(0);
    setup.wake = p.number_of({"wake_fraction"}).value_or(0.2);
  }
  setup.constant = setup.scale * coefficient.value_or(setup.alpha_1.value_or(1));
  setup.max_thrust = p.number_of({"max_thrust_cmd"}).value_or(1000);
  setup.least_thrust = p.number_of({"min_thrust_cmd"}).value_or(-1000);
  if (setup.least_thrust > setup.max_thrust) {
    left_out.push_back(about_propeller(plugin) + "<min_thrust_cmd> must not be more than <max_thrust_cmd>, got " +
                       base::format_number(setup.least_thrust) + " and " + base::format_number(setup.max_thrust) +
                       "; -1000 to 1000 are taken");
    setup.least_thrust = -1000, setup.max_thrust = 1000;
  }
  setup.deadband = p.number_of({"deadband"}).value_or(0);
  setup.has_motor = p.bool_of({"velocity_control"}).value_or(false);
  setup.p = p.number_of({"p_gain"}).value_or(0.1), setup.i = p.number_of({"i_gain"}).value_or(0),
  setup.d = p.number_of({"d_gain"}).value_or(0);
  return setup;
}

// The words of a rotor; what else a file says has a line.
void check_rotor_words(const PluginDef& plugin, std::vector<std::string>& left_out) {
  const auto expect = [&](const char* element, const std::string& otherwise, const std::string& expected, bool is_known) {
    if (!is_known)
      left_out.push_back(about_propeller(plugin) + "<" + element + "> must be " + expected + ", got " +
                         base::in_quotes(plugin.parameters.text_of({element}).value_or("")) + "; " + otherwise + " is taken");
  };
  const std::string direction = plugin.parameters.text_of({"turningDirection"}).value_or("ccw");
  const std::string type = plugin.parameters.text_of({"motorType"}).value_or("velocity");
  expect("turningDirection", "ccw", "cw or ccw", direction == "cw" || direction == "ccw");
  expect("motorType", "velocity", "velocity", type == "velocity");
}

Propeller::Setup rotor_of(const PluginDef& plugin, std::vector<std::string>& left_out) {
  check_rotor_words(plugin, left_out);
  const ParameterNode& p = plugin.parameters;
  const auto number = [&](const char* name, double fallback) { return p.number_of({name}).value_or(fallback); };
  Propeller::Setup setup;
  setup.is_rotor = true;
  setup.constant = number("motorConstant", 8.54858e-6);
  setup.moment = number("momentConstant", 0.016);
  setup.drag = number("rotorDragCoefficient", 1e-4), setup.rolling = number("rollingMomentCoefficient", 1e-6);
  setup.rising = number("timeConstantUp", 1.0 / 80), setup.falling = number("timeConstantDown", 1.0 / 40);
  setup.slowdown = number("rotorVelocitySlowdownSim", 10);
  if (!(setup.slowdown > 0)) setup.slowdown = 10;
  setup.max_speed = std::max(number("maxRotVelocity", 838), 0.0);
  setup.direction = p.text_of({"turningDirection"}).value_or("ccw") == "cw" ? -1 : 1;
  setup.least_thrust = 0;
  return setup;
}

double decay(double dt, double time) { return time > 0 ? std::exp(-dt / time) : 0; }

}  // namespace

Propeller::Propeller(Physics& physics, const Setup& setup, double dt) : setup_(setup) {
  const ModelDef& model = physics.def(setup.joint.model);
  const JointDef& joint = model.joints[setup.joint.joint];
  const LinkDef& link = model.links[setup.link.link];
  joint_axis_ = (link.pose.linear().transpose() * joint.pose_in_model.linear() * joint.axes[0].xyz).normalized();
  axis_ = setup.is_rotor ? Eigen::Vector3d::UnitZ() : joint_axis_;
  center_ = link.center_of_mass;
  inertia_ = std::max(joint_axis_.dot(link.inertia * joint_axis_), 1e-12);
  keep_rising_ = decay(dt, setup.rising), keep_falling_ = decay(dt, setup.falling);
  if (setup_.is_rotor) {
    setup_.max_thrust = setup_.constant * setup_.max_speed * setup_.max_speed;
  } else {
    const double most = std::max(std::abs(setup_.least_thrust), std::abs(setup_.max_thrust));
    setup_.max_speed = setup_.constant != 0 ? std::sqrt(most / std::abs(setup_.constant)) : 0;
  }
}

double Propeller::max_thrust() const { return std::min(std::max(std::abs(setup_.least_thrust), std::abs(setup_.max_thrust)), max_push); }

std::pair<double, double> Propeller::range(bool is_thrust) const {
  if (is_thrust) return {std::max(setup_.least_thrust, -max_push), std::min(setup_.max_thrust, max_push)};
  return {setup_.is_rotor ? 0.0 : -setup_.max_speed, setup_.max_speed};
}

// Of a thruster whose coefficient follows the advance ratio.
double Propeller::constant_now(const Physics& physics, double speed) const {
  if (!setup_.alpha_1 || std::abs(speed) < 1e-6) return setup_.constant;
  const Eigen::Vector3d axis = physics.link_pose(setup_.link).linear() * axis_;
  const double through = axis.dot(physics.link_twist(setup_.link).linear);
  const double coefficient = *setup_.alpha_1 + *setup_.alpha_2 * (1 - *setup_.wake) * through / (speed * setup_.diameter);
  return std::max(coefficient, 0.0) * setup_.scale;
}

void Propeller::set_speed(double speed) {
  if (!std::isfinite(speed)) return;
  is_by_speed_ = true;
  wanted_speed_ = std::clamp(speed, range(false).first, range(false).second);
  wanted_thrust_ = std::clamp(setup_.constant * std::abs(wanted_speed_) * wanted_speed_, setup_.least_thrust, setup_.max_thrust);
}

void Propeller::set_thrust(double thrust) {
  if (!std::isfinite(thrust)) return;
  is_by_speed_ = false;
  wanted_thrust_ = std::clamp(thrust, setup_.least_thrust, setup_.max_thrust);
  // A propeller of the other hand (a negative coefficient) turns backwards to push forwards.
  const double square = setup_.constant != 0 ? wanted_thrust_ / setup_.constant : 0;
  wanted_speed_ = std::copysign(std::sqrt(std::abs(square)), square);
}

void Propeller::before_step(Physics& physics, const Eigen::Vector3d& wind, double dt) {
  setup_.is_rotor ? turn_rotor(physics, wind) : turn_thruster(physics, dt);
}

void Propeller::turn_rotor(Physics& physics, const Eigen::Vector3d& wind) {
  const double turning = physics.joint_state(setup_.joint).velocity * setup_.slowdown;
  const double w = std::abs(turning);
  thrust_ = setup_.direction * std::copysign(setup_.constant * w * w, turning);
  if (w > 0) {
    const Eigen::Isometry3d pose = physics.link_pose(setup_.link);
    const Eigen::Vector3d up = pose.linear().col(2), axis = pose.linear() * joint_axis_;
    const Eigen::Vector3d flow = physics.point_velocity(setup_.link, pose.translation()) - wind;
    const Eigen::Vector3d across = flow - flow.dot(axis) * axis;
    const Eigen::Vector3d force = thrust_ * up - w * setup_.drag * across;
    const Eigen::Vector3d arm = pose * center_ - physics.center_of_mass(setup_.link);
    (void)physics.add_wrench(setup_.link, force, arm.cross(force));
    (void)physics.add_wrench(setup_.parent, Eigen::Vector3d::Zero(),
                             -setup_.direction * thrust_ * setup_.moment * up - w * setup_.rolling * across);
  }
  const double wanted = std::min(wanted_speed_, setup_.max_speed * std::sqrt(strength_));
  const double keep = wanted > filtered_ ? keep_rising_ : keep_falling_;
  filtered_ = keep * filtered_ + (1 - keep) * wanted;
  if (filtered_ < 1e-6) filtered_ = 0;
  physics.set_motor(setup_.joint, 0, setup_.direction * filtered_ / setup_.slowdown, motor_effort);
}

void Propeller::turn_thruster(Physics& physics, double dt) {
  const double most = strength_ * max_thrust();
  double thrust = wanted_thrust_;
  if (setup_.alpha_1 && is_by_speed_) {
    const double constant = constant_now(physics, wanted_speed_);
    thrust = std::clamp(constant * std::abs(wanted_speed_) * wanted_speed_, setup_.least_thrust, setup_.max_thrust);
  }
  thrust_ = std::abs(thrust) < setup_.deadband ? 0 : std::clamp(thrust, -most, most);
  const double speed = std::abs(thrust) < setup_.deadband ? 0 : wanted_speed_ * (thrust != 0 ? std::sqrt(std::abs(thrust_ / thrust)) : 1);
  const Eigen::Isometry3d pose = physics.link_pose(setup_.link);
  const Eigen::Vector3d axis = pose.linear() * axis_;
  double torque = 0;
  if (setup_.has_motor) {
    physics.set_motor(setup_.joint, 0, speed, motor_effort);
  } else {
    const double error = speed - axis.dot(physics.link_twist(setup_.link).angular);
    integral_ = std::clamp(integral_ + setup_.i * error * dt, -1.0, 1.0);
    if (std::abs(error) > settled) torque = setup_.p * error + integral_ + setup_.d * (error - last_error_) / dt;
    last_error_ = error;
    // No more than brings it there in this step.
    const double max_torque = inertia_ * std::abs(error) / dt;
    torque = std::clamp(torque, -max_torque, max_torque);
  }
  if (thrust_ == 0 && torque == 0) return;
  const Eigen::Vector3d force = thrust_ * axis;
  const Eigen::Vector3d arm = pose.translation() - physics.center_of_mass(setup_.link);
  (void)physics.add_wrench(setup_.link, force, arm.cross(force) + torque * axis);
}

double Propeller::speed(const Physics& physics) const {
  const double joint = physics.joint_state(setup_.joint).velocity;
  return setup_.is_rotor ? setup_.direction * joint * setup_.slowdown : joint;
}

void Propeller::reset() {
  wanted_speed_ = wanted_thrust_ = filtered_ = integral_ = last_error_ = thrust_ = 0;
  strength_ = 1;
}

void Propeller::add_to(StateHash& hash) const { hash.add_all(wanted_speed_, wanted_thrust_, filtered_, integral_, last_error_); }

std::shared_ptr<Propellers> Propellers::of(DeviceWorld& world, ModelId model, const std::map<std::uint32_t, std::string>& driven,
                                           std::vector<std::string>& left_out) {
  auto made = std::make_shared<Propellers>();
  const ModelDef& def = world.physics.def(model);
  for (const PluginDef& plugin : def.plugins) {
    if (!is_propeller(kind_of(plugin)) || def.is_static) continue;
    const std::string name = plugin.parameters.text_of({"joint_name", "jointName"}).value_or("");
    const auto joint = joint_named(def, plugin.scope, name);
    const auto refuse = [&](const std::string& why) { left_out.push_back(about_propeller(plugin) + why + "; the plugin is left out"); };
    if (!joint) {
      refuse("model " + base::in_quotes(def.name) + " has no joint " + base::in_quotes(name));
      continue;
    }
    const JointDef& joint_def = def.joints[*joint];
    const bool turns =
        joint_def.axes.size() == 1 && (joint_def.kind == JointDef::Kind::revolute || joint_def.kind == JointDef::Kind::continuous);
    const auto link = link_named(def, {}, joint_def.child);
    if (!turns || !link) {
      refuse("joint " + base::in_quotes(name) + " does not turn a link about one axis");
      continue;
    }
    if (made->find(*joint)) {
      refuse("joint " + base::in_quotes(name) + " has a propeller already");
      continue;
    }
    if (const auto other = driven.find(*joint); other != driven.end()) {
      refuse("joint " + base::in_quotes(name) + " is driven by " + other->second + " already");
      continue;
    }
    Propeller::Setup setup = kind_of(plugin) == PluginKind::rotor ? rotor_of(plugin, left_out) : thruster_of(plugin, left_out);
    setup.joint = {model, *joint};
    setup.link = {model, *link};
    setup.parent = {model, link_named(def, {}, joint_def.parent).value_or(*link)};
    setup.source = plugin.source;
    made->all_.emplace_back(world.physics, setup, world.world.physics.step);
  }
  if (made->all_.empty()) return nullptr;
  made->wishes.resize(made->all_.size());
  made->followed.resize(made->all_.size());
  return made;
}

std::optional<std::size_t> Propellers::find(std::uint32_t joint) const {
  for (std::size_t i = 0; i < all_.size(); ++i) {
    if (all_[i].joint() == joint) return i;
  }
  return std::nullopt;
}

}  // namespace sim
