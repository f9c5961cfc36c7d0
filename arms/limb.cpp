#include "arms/limb.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace arms {
namespace {

constexpr double turn_per_metre = 3;          // [rad/m]
constexpr double time_to_speed = 0.5;         // [s] from rest to the highest speed
constexpr double time_to_rest = 0.2;          // [s] of a motion of the joints
constexpr double near_place = 1e-6;           // [m], [rad] from the goal
constexpr double limb_standing = 0.005;       // [rad] or [m] of joints that have arrived
constexpr double widest_step_of_joint = 0.5;  // [rad] or [m] in one step: another branch
constexpr int points_of_line = 10;            // that are looked at before the arm goes along a line
constexpr double max_speed = 100;             // [m/s]

// What a coordinate that is `missing` from its goal has as velocity next, when it has `now`: fast, but so that it can stop there.
Eigen::Vector3d steered(const Eigen::Vector3d& missing, const Eigen::Vector3d& now, double speed, double acceleration, double dt) {
  const double distance = missing.norm(), step = acceleration * dt;
  const double stopping = std::sqrt(step * step / 4 + 2 * acceleration * distance) - step / 2;
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  if (distance > 0) wanted = missing / distance * std::min({speed, stopping, distance / dt});
  const Eigen::Vector3d change = wanted - now;
  return change.norm() <= step ? wanted : Eigen::Vector3d(now + change * (step / change.norm()));
}

Eigen::Isometry3d moved(Eigen::Isometry3d pose, const Eigen::Vector3d& by, const Eigen::Vector3d& rotation) {
  pose.translation() += by;
  const double angle = rotation.norm();
  if (angle > 0) pose.linear() = Eigen::AngleAxisd(angle, rotation / angle) * pose.linear();
  return pose;
}

}  // namespace

bool Limb::begin(const shm::JointPart& part, double tool, double speed) {
  std::vector<shm::Joint> joints;
  for (std::size_t i = 0; i < part.size(); ++i) joints.push_back(part.joint(i));
  const bool is_chain = begin(joints, tool, speed);
  measure(part);
  return is_chain;
}

bool Limb::begin(std::span<const shm::Joint> joints, double tool, double speed) {
  *this = Limb();
  if (!is_chain(joints)) return false;
  kinematics_ = ArmKinematics(joints);
  for (const shm::Joint& joint : joints) {
    settings_.limits.push_back({joint.lower, joint.upper});
    settings_.max_speeds.push_back(joint.max_velocity);
    home_.push_back(joint.rest);
  }
  settings_.joint_ratio = 1, settings_.joint_time = time_to_speed;
  tool_.translation().z() = tool;
  measured_ = commanded_ = home_;
  velocities_.assign(home_.size(), 0);
  if (speed > 0 && speed <= max_speed) speed_ = speed;
  return true;
}

void Limb::measure(const std::vector<double>& positions, bool is_blocked) {
  measured_ = positions;
  if (!is_blocked || way_ == Way::none || has_collided_) return;
  next_.reset();
  start_from_here();
  asked_.reset();
  has_collided_ = true;
}

// Blocked: a joint is at its highest effort and does not move.
void Limb::measure(const shm::JointPart& part) {
  if (!is_there() || !part.has_states()) return;
  std::vector<double> positions;
  bool is_blocked = false;
  for (std::size_t i = 0; i < part.size(); ++i) {
    positions.push_back(part.state(i).position);
    is_blocked = is_blocked || part.state(i).status == RTMSIM_JOINT_STALLED;
  }
  measure(positions, is_blocked);
}

Reply Limb::set_speed(double speed) {
  if (!(speed > 0 && speed <= max_speed))
    return wrong_value("a speed must be above 0 and at most 100 m/s, got " + number_text(speed) + "; it is ignored");
  speed_ = speed;
  return {};
}

void Limb::let_go() {
  way_ = Way::none;
  asked_.reset(), goal_.reset(), motion_.reset(), next_.reset();
  is_stopping_ = is_out_of_reach_ = has_collided_ = false;
  twist_ = {};
}

void Limb::settle() {
  if (std::exchange(was_held_, is_held()) == is_held()) return;
  must_brake_ = is_held();
  if (is_held()) {
    let_go();
  } else if (is_there()) {
    start_from_here();
  }
}

void Limb::start_from_here() {
  commanded_ = measured_;
  for (std::size_t i = 0; i < commanded_.size(); ++i)
    commanded_[i] = std::clamp(commanded_[i], settings_.limits[i].low, settings_.limits[i].high);
  stand();
}

void Limb::stand() {
  way_ = Way::standing;
  goal_.reset(), motion_.reset();
  is_stopping_ = false;
  twist_ = {};
  std::ranges::fill(velocities_, 0);
  if (next_) {
    (void)go_by_joints(*std::exchange(next_, std::nullopt));
  } else {
    asked_.reset();
  }
}

Reply Limb::may_move() const {
  if (!is_there()) return {Answer::fault, "the joints are no chain from base to tip"};
  if (is_held()) return {Answer::wrong_state, is_powered_ ? "the brakes are on" : "the power is off"};
  return {};
}

Reply Limb::go(const Eigen::Isometry3d& goal) {
  constexpr double same = 1e-9;
  if (Reply may = may_move(); !may.is_ok()) return may;
  if (!goal.matrix().allFinite() || !is_rotation(goal.linear())) return wrong_value("a pose must be finite, its axes orthonormal");
  if (asked_ && asked_->isApprox(goal, same)) return {};
  if (way_ == Way::none) start_from_here();
  if (!is_out_of_reach_ || !refused_ || !refused_->isApprox(goal, same)) {
    if (Reply reply = start(goal); reply.is_ok()) return reply;
  }
  refused_ = goal;
  is_out_of_reach_ = true;
  return wrong_value("the arm cannot reach the pose");
}

Reply Limb::start(const Eigen::Isometry3d& goal) {
  const auto solution = kinematics_.solve(goal * tool_.inverse(), commanded_);
  if (!solution) return wrong_value("");
  is_out_of_reach_ = has_collided_ = false;
  asked_ = goal;
  if (!is_line_possible(goal)) return go_by_joints(*solution);
  next_.reset(), motion_.reset();
  goal_ = goal;
  way_ = Way::line, is_stopping_ = false;
  return {};
}

Reply Limb::go_to_place(const Eigen::Vector3d& place) {
  Eigen::Isometry3d goal = goal_ && way_ == Way::line ? *goal_ : tip(way_ == Way::none ? measured_ : commanded_);
  goal.translation() = place;
  if (Reply straight = go(goal); straight.is_ok() || !is_out_of_reach_) return straight;
  const auto solution = kinematics_.solve_place(place, tool_.translation(), commanded_);
  if (!solution) return wrong_value("the arm cannot reach the place");
  is_out_of_reach_ = has_collided_ = false;
  asked_.reset();
  return go_by_joints(*solution);
}

Reply Limb::go_along(const Eigen::Vector3d& direction, double length) {
  const double size = direction.norm();
  if (!(size > 0) || !std::isfinite(size * length)) return wrong_value("a direction must be finite and not zero");
  Eigen::Isometry3d goal = tip(way_ == Way::none ? measured_ : commanded_);
  goal.translation() += direction * (length / size);
  return go(goal);
}

Reply Limb::go_home() {
  if (Reply may = may_move(); !may.is_ok()) return may;
  if (way_ == Way::none) start_from_here();
  is_out_of_reach_ = has_collided_ = false;
  asked_.reset();
  return go_by_joints(home_);
}

void Limb::stop() {
  asked_.reset(), next_.reset();
  come_to_rest();
}

// From rest: what moves comes to rest first.
Reply Limb::go_by_joints(const Positions& goal) {
  if (way_ == Way::line || way_ == Way::joints) {
    come_to_rest();
    next_ = goal;
    return {};
  }
  Plan plan = Planner(kinematics_, settings_).to_joints(commanded_, goal, false);
  if (!plan.motion) return plan.reply;
  motion_ = std::move(plan.motion);
  time_ = 0, pace_ = 1;
  way_ = Way::joints, is_stopping_ = false;
  return {};
}

// Looks at some points only: where the joints turn out to be unable on the way, the rest is gone through joint space.
bool Limb::is_line_possible(const Eigen::Isometry3d& goal) const {
  const Eigen::Isometry3d from = tip(commanded_);
  const Eigen::Matrix<double, 6, 1> way = difference(goal, from);
  Positions at = commanded_;
  for (int i = 1; i <= points_of_line; ++i) {
    const double part = static_cast<double>(i) / points_of_line;
    const Eigen::Isometry3d pose = i == points_of_line ? goal : moved(from, part * way.head<3>(), part * way.tail<3>());
    const auto next = kinematics_.solve_near(pose * tool_.inverse(), at);
    if (!next) return false;
    at = *next;
  }
  return true;
}

// False: the joints cannot.
bool Limb::move_tip(const Twist& twist, double dt) {
  const Eigen::Isometry3d pose = moved(tip(commanded_), dt * twist.linear, dt * twist.angular);
  const auto next = kinematics_.solve_near(pose * tool_.inverse(), commanded_);
  if (!next) return false;
  for (std::size_t i = 0; i < next->size(); ++i) {
    if (std::abs((*next)[i] - commanded_[i]) > widest_step_of_joint) return false;
  }
  for (std::size_t i = 0; i < next->size(); ++i) velocities_[i] = ((*next)[i] - commanded_[i]) / dt;
  commanded_ = *next;
  return true;
}

void Limb::advance_line(double dt) {
  const Eigen::Isometry3d from = tip(commanded_);
  Eigen::Matrix<double, 6, 1> missing = difference(*goal_, from);
  if (is_stopping_) missing.setZero();
  const double acceleration = speed_ / time_to_speed;
  Twist twist;
  twist.linear = steered(missing.head<3>(), twist_.linear, speed_, acceleration, dt);
  twist.angular = steered(missing.tail<3>(), twist_.angular, turn_per_metre * speed_, turn_per_metre * acceleration, dt);
  const bool is_slow = twist_.linear.norm() <= 2 * acceleration * dt && twist_.angular.norm() <= 2 * turn_per_metre * acceleration * dt;
  const bool is_there = !is_stopping_ && is_slow && missing.head<3>().norm() < near_place && missing.tail<3>().norm() < near_place;
  if (twist.is_zero() || is_there) return stand();
  const Positions before = commanded_;
  if (!move_tip(twist, dt)) {
    // Through joint space, from rest.
    const auto solution = kinematics_.solve(*goal_ * tool_.inverse(), commanded_);
    const bool is_wanted = !is_stopping_ && solution.has_value();
    is_out_of_reach_ = !is_stopping_ && !solution;
    if (is_wanted) next_ = *solution;
    return stand();
  }
  // A joint that would be too fast slows all of them down.
  double share = 1;
  for (std::size_t i = 0; i < before.size(); ++i)
    share = std::min(share, settings_.max_speeds[i] * dt / std::max(std::abs(commanded_[i] - before[i]), 1e-12));
  if (share < 1) {
    for (std::size_t i = 0; i < before.size(); ++i) commanded_[i] = before[i] + share * (commanded_[i] - before[i]);
    for (double& velocity : velocities_) velocity *= share;
    twist.linear *= share, twist.angular *= share;
  }
  twist_ = twist;
}

void Limb::advance_joints(double dt) {
  const Eigen::Isometry3d before = tip(commanded_);
  if (is_stopping_) pace_ = std::max(0.0, pace_ - dt / time_to_rest);
  time_ += pace_ * dt;
  commanded_ = motion_->positions(time_);
  velocities_ = motion_->velocities(time_);
  for (double& velocity : velocities_) velocity *= pace_;
  if (time_ >= motion_->duration() || pace_ == 0) return stand();
  const Eigen::Matrix<double, 6, 1> way = difference(tip(commanded_), before);
  twist_ = {way.head<3>() / dt, way.tail<3>() / dt};
}

Limb::Command Limb::advance(double dt, bool was_reset) {
  if (was_reset) let_go(), must_brake_ = is_held();
  if (std::exchange(must_brake_, false)) return {Command::Kind::brake};
  if (dt > 0 && way_ == Way::line) {
    advance_line(dt);
  } else if (dt > 0 && way_ == Way::joints) {
    advance_joints(dt);
  }
  if (way_ == Way::none) return {};
  return {Command::Kind::follow, commanded_, velocities_};
}

base::Result<void> Limb::step(shm::JointPart& part) {
  if (!is_there()) return {};
  measure(part);
  return command(advance(part.dt(), part.was_reset()), part);
}

Limb::Status Limb::status() const {
  if (is_held()) return Status::braked;
  if (has_collided_) return Status::collision;
  bool has_arrived = way_ == Way::none || way_ == Way::standing;
  for (std::size_t i = 0; way_ == Way::standing && i < measured_.size(); ++i)
    has_arrived = has_arrived && std::abs(measured_[i] - commanded_[i]) < limb_standing;
  if (!has_arrived) return Status::moving;
  return is_out_of_reach_ ? Status::out_of_reach : Status::idle;
}

Eigen::Isometry3d Limb::pose() const { return tip(measured_); }

base::Result<void> command(const Limb::Command& command, shm::JointPart& part) {
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (command.kind == Limb::Command::Kind::brake) part.brake(i);
    if (command.kind != Limb::Command::Kind::follow) continue;
    if (const auto done = part.follow(i, command.positions[i], command.velocities[i], 0); !done) return done;
  }
  return {};
}

}  // namespace arms
