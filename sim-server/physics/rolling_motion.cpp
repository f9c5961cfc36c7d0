#include "physics/rolling_motion.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace sim {
namespace {

constexpr double grip_share = 0.8;   // of the friction that wheels may use: ODE's friction is a pyramid along any axes
constexpr double least_load = 0.02;  // of the mean load of a contact; below, it is about to lift off
// A slide's friction grows with its speed up to this many times the change of the robot's speed that it makes in a step: so it stops the
// robot, and never turns it round.
constexpr double creep = 2.5;

}  // namespace

std::optional<RollingMotion> RollingMotion::of(const RollingMass& mass, const std::array<RollingWheel, 2>& wheels,
                                               std::vector<RollingSlide> slides, double gravity) {
  RollingMotion m;
  m.mass_ = mass;
  m.wheels_ = wheels;
  m.slides_ = std::move(slides);
  m.gravity_ = gravity;
  const double track = wheels[1].side - wheels[0].side;
  if (!(std::abs(track) > 1e-3) || !(std::abs(wheels[0].reach * wheels[1].reach) > 1e-8)) return std::nullopt;
  // forward - yaw * side = reach * rate, of both.
  for (std::size_t i = 0; i < 2; ++i) {
    const double sign = i == 0 ? 1 : -1;
    m.to_speeds_[1][i] = sign * wheels[i].reach / track;
    m.to_speeds_[0][i] = sign * wheels[i].reach * wheels[1 - i].side / track;
  }
  double whole = mass.mass, coupling = -mass.mass * mass.y;
  double yaw = mass.yaw_inertia + mass.mass * (mass.x * mass.x + mass.y * mass.y);
  for (const auto& slide : m.slides_) {
    whole += slide.ball, coupling -= slide.ball * slide.y;
    yaw += slide.ball * (slide.x * slide.x + slide.y * slide.y);
  }
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 2; ++k) {
      const auto &t = m.to_speeds_[0], &w = m.to_speeds_[1];
      m.inertia_[i][k] = whole * t[i] * t[k] + coupling * (t[i] * w[k] + w[i] * t[k]) + yaw * w[i] * w[k];
    }
    m.inertia_[i][i] += wheels[static_cast<std::size_t>(i)].inertia;
  }
  m.forces_.resize(m.contacts());
  m.next_forces_.resize(m.contacts());
  m.grips_.resize(m.contacts());
  if (!m.share_weight(gravity)) return std::nullopt;
  return m;
}

// All contacts are equal springs under a rigid body: the load of each is a plane over their places.
bool RollingMotion::share_weight(double gravity) {
  std::vector<Eigen::Vector3d> places;
  for (const auto& wheel : wheels_) places.emplace_back(1, 0, wheel.side);
  for (const auto& slide : slides_) places.emplace_back(1, slide.x, slide.y);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& place : places) sum += place * place.transpose();
  if (!(std::abs(sum.determinant()) > 1e-9)) return false;  // they lie on one line
  const Eigen::Matrix3d inverse = sum.inverse();
  for (const auto& place : places) {
    const Eigen::Vector3d share = inverse * place;
    share_.push_back({share.x(), share.y(), share.z()});
  }
  gravity_ = gravity;
  return load({}, 0, forces_);
}

RollingMotion::Speeds RollingMotion::speeds_of(const std::array<double, 2>& w) const {
  return {w, to_speeds_[0][0] * w[0] + to_speeds_[0][1] * w[1], to_speeds_[1][0] * w[0] + to_speeds_[1][1] * w[1]};
}

void RollingMotion::start(const std::array<double, 2>& wheel_rates) {
  speeds_ = speeds_of(wheel_rates);
  static_cast<void>(load({}, speeds_.yaw, forces_));
}

void RollingMotion::stand() { start({0, 0}); }

// What each contact can hold by friction. ODE takes the loads from a solution without any friction, in which motors turn their wheels
// freely, and the body the other way.
void RollingMotion::find_grips(const std::array<RollingMotor, 2>& motors, double dt) {
  double about_y = mass_.mass * gravity_ * mass_.x, spin = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const double sense = wheels_[i].reach > 0 ? 1 : -1;
    const double free = wheels_[i].inertia * (motors[i].rate - speeds_.wheels[i]) / dt;
    about_y -= sense * std::clamp(free, -motors[i].effort, motors[i].effort);
    spin += sense * wheels_[i].inertia * speeds_.wheels[i];
  }
  const double weight = mass_.mass * gravity_, about_x = weight * mass_.y - speeds_.yaw * spin;
  for (std::size_t i = 0; i < contacts(); ++i) {
    const double friction = i < 2 ? wheels_[i].friction : slides_[i - 2].friction;
    grips_[i] = friction * std::max(share_[i][0] * weight + share_[i][1] * about_y + share_[i][2] * about_x, 0.0);
  }
}

// The friction of all slides: along x, along y, about z.
std::array<double, 3> RollingMotion::slide_forces(double dt) {
  std::array<double, 3> sum{0, 0, 0};
  for (std::size_t i = 0; i < slides_.size(); ++i) {
    const RollingSlide& slide = slides_[i];
    auto& force = next_forces_[i + 2];
    force = {0, 0, 0};
    const double most = grips_[i + 2];
    if (most <= 0) continue;
    const double vx = speeds_.forward - speeds_.yaw * slide.y, vy = speeds_.yaw * slide.x;
    const double share = -most / std::max(std::sqrt(vx * vx + vy * vy), creep * most * dt / mass_.mass);
    force = {share * vx, share * vy, 0};
    sum[0] += force[0], sum[1] += force[1], sum[2] += slide.x * force[1] - slide.y * force[0];
  }
  return sum;
}

// The rates after the step: each motor reaches its rate, or gives all its effort.
bool RollingMotion::solve(const std::array<RollingMotor, 2>& motors, const std::array<double, 2>& push, double dt,
                          std::array<double, 2>& rates, std::array<double, 2>& efforts) const {
  constexpr double slack = 1e-9;
  const auto& m = inertia_;
  for (const int first : {0, 1, -1}) {
    for (const int second : {0, 1, -1}) {
      const int side[2] = {first, second};
      double change[2];
      for (std::size_t i = 0; i < 2; ++i) change[i] = motors[i].rate - speeds_.wheels[i], efforts[i] = side[i] * motors[i].effort;
      if (first != 0 && second != 0) {
        const double a = dt * (efforts[0] + push[0]), b = dt * (efforts[1] + push[1]), det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
        change[0] = (a * m[1][1] - b * m[0][1]) / det, change[1] = (b * m[0][0] - a * m[1][0]) / det;
      } else if (first != 0) {
        change[0] = (dt * (efforts[0] + push[0]) - m[0][1] * change[1]) / m[0][0];
      } else if (second != 0) {
        change[1] = (dt * (efforts[1] + push[1]) - m[1][0] * change[0]) / m[1][1];
      }
      bool is_solution = true;
      for (std::size_t i = 0; i < 2; ++i) {
        const double needed = (m[i][0] * change[0] + m[i][1] * change[1]) / dt - push[i];
        if (side[i] == 0) efforts[i] = needed;
        rates[i] = speeds_.wheels[i] + change[i];
        is_solution =
            is_solution && (side[i] == 0 ? std::abs(needed) <= motors[i].effort + slack : side[i] * (motors[i].rate - rates[i]) >= -slack);
      }
      if (is_solution) return true;
    }
  }
  return false;
}

bool RollingMotion::load(const Accelerations& now, double yaw, std::vector<std::array<double, 3>>& forces) const {
  double spin = 0, spin_change = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const double sense = wheels_[i].reach > 0 ? 1 : -1;
    spin += sense * wheels_[i].inertia * speeds_.wheels[i];
    spin_change += sense * wheels_[i].inertia * now.wheels[i];
  }
  const double weight = mass_.mass * gravity_;
  const double about_y = weight * mass_.x - mass_.mass * mass_.height * now.forward - spin_change;
  const double about_x = weight * mass_.y - mass_.mass * mass_.height * now.side - yaw * spin;
  const double least = least_load * weight / static_cast<double>(contacts());
  for (std::size_t i = 0; i < contacts(); ++i) {
    forces[i][2] = share_[i][0] * weight + share_[i][1] * about_y + share_[i][2] * about_x;
    if (!(forces[i][2] > least)) return false;
  }
  return true;
}

// What the wheels must put on the ground, against what their loads let them.
bool RollingMotion::grips(const Accelerations& now, const std::array<double, 2>& efforts, double slide_y,
                          std::vector<std::array<double, 3>>& forces) const {
  const double side = (mass_.mass * now.side - slide_y) / 2;
  for (std::size_t i = 0; i < 2; ++i) {
    const double along = (efforts[i] - wheels_[i].damping * speeds_.wheels[i] - wheels_[i].inertia * now.wheels[i]) / wheels_[i].reach;
    forces[i][0] = along, forces[i][1] = side;
    if (!(std::abs(along) + std::abs(side) <= grip_share * grips_[i])) return false;
  }
  return true;
}

bool RollingMotion::step(const std::array<RollingMotor, 2>& motors, double dt) {
  find_grips(motors, dt);
  const std::array<double, 3> slid = slide_forces(dt);
  const double v = speeds_.forward, w = speeds_.yaw;
  // Inertia of a centre of mass beside the axle, in a turn.
  const double along = slid[0] + mass_.mass * mass_.x * w * w, about = slid[2] - mass_.mass * mass_.x * v * w;
  std::array<double, 2> push{to_speeds_[0][0] * along + to_speeds_[1][0] * about, to_speeds_[0][1] * along + to_speeds_[1][1] * about};
  for (std::size_t i = 0; i < 2; ++i) push[i] -= wheels_[i].damping * speeds_.wheels[i];
  std::array<double, 2> rates{0, 0}, efforts{0, 0};
  if (!solve(motors, push, dt, rates, efforts)) return false;
  const Speeds next = speeds_of(rates);
  const double turn = (next.yaw - w) / dt;
  Accelerations now;
  now.forward = (next.forward - v) / dt - turn * mass_.y - w * w * mass_.x;
  now.side = turn * mass_.x + w * (v - w * mass_.y);
  for (std::size_t i = 0; i < 2; ++i) now.wheels[i] = (rates[i] - speeds_.wheels[i]) / dt;
  if (!load(now, w, next_forces_) || !grips(now, efforts, slid[1], next_forces_)) return false;
  speeds_ = next;
  std::swap(forces_, next_forces_);
  return true;
}

}  // namespace sim
