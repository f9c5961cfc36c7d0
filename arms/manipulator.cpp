#include "arms/manipulator.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace arms {
namespace {

constexpr double overshoot = 0.02;                        // [rad] or [m] beyond a soft limit that is not an alarm
constexpr double stop_time = 0.2;                         // [s] from full pace to rest
constexpr double min_finger_time = 0.1;                   // [s] before fingers that do not move have arrived
constexpr double standing_error = 0.005;                  // [rad] or [m]
constexpr double overspeed = 1.5, least_overspeed = 0.2;  // times the highest speed of a joint, and [rad/s] or [m/s] beside it
constexpr double time_of_speed = 0.05;                    // [s] in which a speed is measured
constexpr std::uint32_t emergency_alarm = 1, overload_alarm = 2, overspeed_alarm = 3, joint_limit_alarm = 4, cartesian_limit_alarm = 5;

Reply refuse(Answer answer, std::string comment) { return {answer, std::move(comment)}; }

Reply check_count(std::size_t count, std::size_t expected, const char* what) {
  if (count == expected) return {};
  return wrong_value(std::string(what) + ": expected " + std::to_string(expected) + " values, got " + std::to_string(count));
}

Reply check_percent(std::uint32_t percent) {
  return percent <= 100 ? Reply{} : wrong_value("a speed must be within 0 and 100 %, got " + std::to_string(percent));
}

Reply check_time(double time, double min) {
  constexpr double max = 100;
  if (time >= min && time <= max) return {};
  return wrong_value("an acceleration time must be within " + number_text(min) + " and 100 s, got " + number_text(time));
}

Reply check_offset(const Eigen::Isometry3d& offset) {
  if (!is_rotation(offset.linear())) return wrong_value("the rotation part of the offset is not a rotation");
  return offset.translation().allFinite() ? Reply{} : wrong_value("the position of the offset is not finite");
}

}  // namespace

void Manipulator::begin(std::span<const shm::Joint> joints, bool has_fingers, double speed_ratio, int command_cycle_ms) {
  const std::uint64_t drops = drops_;
  *this = Manipulator();
  drops_ = drops + 1;
  kinematics_ = ArmKinematics(joints);
  has_fingers_ = has_fingers;
  for (const shm::Joint& joint : joints) {
    settings_.limits.push_back({joint.lower, joint.upper});
    settings_.max_speeds.push_back(joint.max_velocity);
    home_.push_back(joint.rest);
  }
  settings_.command_cycle_ms = command_cycle_ms;
  settings_.joint_ratio = settings_.cartesian_ratio = speed_ratio;
  hard_limits_ = settings_.limits, hard_speeds_ = settings_.max_speeds;
  feedback_.positions = planned_ = hold_ = home_;
  is_outside_.assign(joints.size() + 1, false);
  check_limits(false);
}

void Manipulator::restart() {
  is_servo_on_ = false;
  std::erase_if(alarms_, [](const Alarm& alarm) { return !alarm.is_fault; });
  measured_from_.clear();
  hold_here();
  check_limits(false);
}

// A joint can be a little beyond the stop that it is pressed on.
void Manipulator::hold_here() {
  hold_ = feedback_.positions;
  for (std::size_t i = 0; i < hold_.size(); ++i) hold_[i] = std::clamp(hold_[i], hard_limits_[i].low, hard_limits_[i].high);
  drop();
}

// --- each tick

void Manipulator::feed(Feedback feedback) {
  feedback_ = std::move(feedback);
  if (!is_servo_on_) planned_ = hold_ = feedback_.positions;
  check_limits(true);
  if (is_servo_on_ && alarms_.empty() && feedback_.overloaded)
    raise(overload_alarm, "joint " + std::to_string(*feedback_.overloaded + 1) + " is at its highest effort and does not move");
}

// An alarm is raised when a limit is passed, not while the arm is beyond it: so it can be moved back.
void Manipulator::check_limits(bool is_alarm) {
  const auto& limits = settings_.limits;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const double position = feedback_.positions[i];
    const bool is_outside = !limits[i].contains(position, overshoot);
    if (is_outside && !is_outside_[i] && is_alarm)
      raise(joint_limit_alarm, "joint " + std::to_string(i + 1) + " is at " + number_text(position) + ", beyond its soft limits " +
                                   number_text(limits[i].low) + " and " + number_text(limits[i].high));
    is_outside_[i] = is_outside;
  }
  const Eigen::Vector3d at = pose().translation();
  bool is_outside = false;
  for (std::size_t k = 0; k < 3; ++k) is_outside = is_outside || !settings_.box[k].contains(at[static_cast<Eigen::Index>(k)], overshoot);
  if (is_outside && !is_outside_.back() && is_alarm)
    raise(cartesian_limit_alarm, "the control point is at (" + number_text(at.x()) + ", " + number_text(at.y()) + ", " +
                                     number_text(at.z()) + "), beyond the Cartesian soft limits");
  is_outside_.back() = is_outside;
}

// Faster than its motor can turn it: something drives the arm. Over a time in which the rattling of a contact moves nothing. Raised once
// for each time.
void Manipulator::check_speeds(double dt) {
  measured_for_ += dt;
  if (measured_from_.size() == feedback_.positions.size() && measured_for_ < time_of_speed) return;
  std::optional<std::size_t> fastest;
  double speed = 0;
  for (std::size_t i = 0; i < measured_from_.size() && i < hard_speeds_.size() && measured_for_ > 0; ++i) {
    double way = feedback_.positions[i] - measured_from_[i];
    if (std::isinf(hard_limits_[i].low) && std::isinf(hard_limits_[i].high)) way = std::remainder(way, 2 * M_PI);  // may not count turns
    if (std::abs(way) / measured_for_ <= overspeed * hard_speeds_[i] + least_overspeed) continue;
    fastest = i, speed = way / measured_for_;
  }
  if (fastest && !is_too_fast_)
    raise(overspeed_alarm, "joint " + std::to_string(*fastest + 1) + " moves at " + number_text(speed) +
                               " [rad/s or m/s], its highest speed is " + number_text(hard_speeds_[*fastest]));
  is_too_fast_ = fastest.has_value();
  measured_from_ = feedback_.positions, measured_for_ = 0;
}

void Manipulator::set_emergency(bool is_on) {
  if (std::exchange(is_emergency_, is_on) == is_on) return;
  for (Alarm& alarm : alarms_) alarm.is_fault = alarm.code == emergency_alarm && is_on;
  if (!is_on) return;
  const bool has_one = std::any_of(alarms_.begin(), alarms_.end(), [](const Alarm& alarm) { return alarm.code == emergency_alarm; });
  if (!has_one) alarms_.push_back({emergency_alarm, "emergency stop", true});
  hold_here();
  is_servo_on_ = false;
}

// Stops the arm where it is. Without a servo nothing moves that could be stopped.
void Manipulator::raise(std::uint32_t code, std::string description) {
  if (!is_servo_on_) return;
  alarms_.push_back({code, std::move(description)});
  hold_here();
}

void Manipulator::drop() {
  if (finger_time_) finger_command_ = FingerCommand{};
  finger_time_.reset();
  queue_.clear();
  low_level_.clear();
  time_ = 0, pace_ = 1;
  is_paused_ = false;
  stopping_.reset();
  planned_ = hold_;
  ++drops_;
}

std::optional<Manipulator::Target> Manipulator::advance(double dt) {
  check_speeds(dt);
  if (!is_servo_on_) return std::nullopt;
  Target target{hold_, std::vector<double>(hold_.size(), 0.0)};
  const double wanted = is_paused_ ? 0 : 1, change = dt / stop_time;
  if (!stopping_) pace_ += std::clamp(wanted - pace_, -change, change);
  if (queue_.empty()) {
    advance_low_level(dt, target);
  } else if (std::holds_alternative<Motion>(queue_.front())) {
    advance_motion(dt, target);
  } else if (pace_ > 0 && advance_fingers(dt)) {
    queue_.pop_front();
  }
  return target;
}

void Manipulator::advance_motion(double dt, Target& target) {
  const Motion& motion = std::get<Motion>(queue_.front());
  if (stopping_) {
    stopping_->time += dt;
    const double left = std::max(stopping_->pace - stopping_->time / stop_time, 0.0);
    pace_ = left;
    time_ = std::min(end_of_stop() - left * left * stop_time / 2, motion.duration());
  } else {
    time_ += pace_ * dt;
  }
  target = {motion.positions(time_), motion.velocities(time_)};
  for (double& velocity : target.velocities) velocity *= pace_;
  hold_ = target.positions;
  const bool has_stopped = stopping_ && pace_ == 0;
  if (time_ < motion.duration() && !has_stopped) return;
  queue_.pop_front();
  time_ = 0;
  if (stopping_) stopping_.reset(), pace_ = 1;
}

// The time on the motion at which it comes to rest.
double Manipulator::end_of_stop() const { return stopping_->from + stopping_->pace * stopping_->pace * stop_time / 2; }

bool Manipulator::advance_fingers(double dt) {
  if (!finger_time_) finger_command_ = std::get<FingerCommand>(queue_.front()), finger_time_ = 0;
  *finger_time_ += dt;
  if (*finger_time_ < min_finger_time || !feedback_.are_fingers_still) return false;
  finger_time_.reset();
  return true;
}

void Manipulator::advance_low_level(double dt, Target& target) {
  if (low_level_.empty()) return;
  const double left = std::max(low_level_left_, dt);
  for (std::size_t i = 0; dt > 0 && i < hold_.size(); ++i) {
    const double max = settings_.max_speeds[i] * dt;
    const double step = std::clamp((low_level_[i] - hold_[i]) * dt / left, -max, max);
    hold_[i] += step;
    target.velocities[i] = step / dt;
  }
  low_level_left_ -= dt;
  const auto has_arrived = [&](std::size_t i) { return std::abs(low_level_[i] - hold_[i]) < 1e-9; };
  bool is_there = low_level_left_ <= 0;
  for (std::size_t i = 0; is_there && i < hold_.size(); ++i) is_there = has_arrived(i);
  if (is_there) hold_ = std::exchange(low_level_, {});
  target.positions = planned_ = hold_;
}

Reply Manipulator::follow(const std::vector<double>& positions) {
  if (Reply state = may_move(); !state.is_ok()) return state;
  if (!queue_.empty()) return refuse(Answer::wrong_state, "motions of the middle level are queued");
  if (Reply value = planner().check_joints(positions); !value.is_ok()) return value;
  low_level_ = positions, low_level_left_ = settings_.command_cycle_ms * 1e-3;
  return {};
}

std::optional<FingerCommand> Manipulator::take_finger_command() { return std::exchange(finger_command_, std::nullopt); }

// --- common level

std::uint32_t Manipulator::state() const {
  bool stands = queue_.empty() && low_level_.empty();
  for (std::size_t i = 0; is_servo_on_ && stands && i < hold_.size(); ++i)
    stands = std::abs(feedback_.positions[i] - hold_[i]) < standing_error;
  return (is_servo_on_ ? has_servo : 0) | (stands ? 0 : is_moving) | (alarms_.empty() ? 0 : has_alarm) |
         (queue_.size() >= max_motions ? is_full : 0) | (is_paused_ ? is_paused : 0);
}

Reply Manipulator::clear_alarms() {
  std::erase_if(alarms_, [](const Alarm& alarm) { return !alarm.is_fault; });
  return alarms_.empty() ? Reply{} : refuse(Answer::wrong_state, "the signal of the emergency stop is on");
}

Reply Manipulator::set_servo(bool is_on) {
  if (is_on == is_servo_on_) return {};
  if (is_on && is_emergency_) return refuse(Answer::wrong_state, "the signal of the emergency stop is on");
  hold_here();
  is_servo_on_ = is_on;
  return {};
}

Reply Manipulator::may_configure(const char* what) const {
  if ((state() & (is_moving | has_alarm)) == 0) return {};
  return refuse(Answer::wrong_state, std::string(what) + " cannot be set while the arm moves or has an alarm");
}

Reply Manipulator::set_soft_limits(const std::vector<Range>& limits) {
  if (Reply state = may_configure("soft limits"); !state.is_ok()) return state;
  if (Reply count = check_count(limits.size(), hold_.size(), "limits"); !count.is_ok()) return count;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const Range& hard = hard_limits_[i];
    if (limits[i].low >= hard.low && limits[i].high <= hard.high && limits[i].low < limits[i].high) continue;
    return wrong_value("joint " + std::to_string(i + 1) + ": limits must ascend within " + number_text(hard.low) + " and " +
                       number_text(hard.high) + " [rad or m], got " + number_text(limits[i].low) + " and " + number_text(limits[i].high));
  }
  settings_.limits = limits;
  check_limits(false);
  return {};
}

// --- middle level: motions

Reply Manipulator::may_move() const {
  if (!is_servo_on_) return refuse(Answer::servo_off, "the servo is off; servoON switches it on");
  if (!alarms_.empty()) return refuse(Answer::wrong_state, "alarm: " + alarms_.front().description + "; clearAlarms clears it");
  if (queue_.size() >= max_motions) return refuse(Answer::queue_full, std::to_string(max_motions) + " motions are queued");
  return {};
}

std::variant<Manipulator::Planning, Reply> Manipulator::planning() const {
  if (Reply state = may_move(); !state.is_ok()) return state;
  return Planning{planner(), planned_, drops_};
}

Reply Manipulator::add(Motion motion, std::uint64_t drops) {
  if (Reply state = may_move(); !state.is_ok()) return state;
  if (drops != drops_) return refuse(Answer::wrong_state, "the arm was stopped while the motion was planned");
  low_level_.clear();
  planned_ = motion.end();
  queue_.emplace_back(std::move(motion));
  return {};
}

Reply Manipulator::move(const std::function<Plan(const Planner& planner, const std::vector<double>& from)>& plan) {
  const auto start = planning();
  if (const Reply* reply = std::get_if<Reply>(&start)) return *reply;
  const auto& with = std::get<Planning>(start);
  Plan made = plan(with.planner, with.from);
  return made.motion ? add(std::move(*made.motion), with.drops) : made.reply;
}

Reply Manipulator::move_fingers(const FingerCommand& command) {
  if (Reply state = may_move(); !state.is_ok()) return state;
  if (!has_fingers_) return refuse(Answer::fault, "the arm has no gripper");
  if (!(command.ratio >= 0 && command.ratio <= 1))
    return wrong_value("a gripper's ratio must be within 0 and 100 %, got " + number_text(100 * command.ratio));
  low_level_.clear();
  queue_.emplace_back(command);
  return {};
}

Reply Manipulator::pause() {
  if (is_servo_on_ && alarms_.empty() && !queue_.empty() && !stopping_) is_paused_ = true;
  return {};
}

Reply Manipulator::resume() {
  is_paused_ = false;
  return {};
}

// The arm comes to rest on its path; where, is known now, so that the next motion can be planned at once.
Reply Manipulator::stop() {
  if (!is_servo_on_ || !alarms_.empty()) return {};
  const bool moves = !queue_.empty() && std::holds_alternative<Motion>(queue_.front()) && pace_ > 0;
  if (!moves) return drop(), Reply{};
  while (queue_.size() > 1) queue_.pop_back();
  is_paused_ = false;
  if (!stopping_) stopping_ = Stopping{time_, pace_, 0};
  planned_ = std::get<Motion>(queue_.front()).positions(end_of_stop());
  ++drops_;
  return {};
}

// --- middle level: settings

Reply Manipulator::set_joint_speed(std::uint32_t percent) {
  if (Reply value = check_percent(percent); !value.is_ok()) return value;
  settings_.joint_ratio = percent / 100.0;
  return {};
}

Reply Manipulator::set_cartesian_speed(std::uint32_t percent) {
  if (Reply value = check_percent(percent); !value.is_ok()) return value;
  settings_.cartesian_ratio = percent / 100.0;
  return {};
}

Reply Manipulator::set_max_joint_speeds(const std::vector<double>& speeds) {
  if (Reply count = check_count(speeds.size(), hold_.size(), "speeds"); !count.is_ok()) return count;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    if (speeds[i] > 0 && speeds[i] <= hard_speeds_[i]) continue;
    return wrong_value("joint " + std::to_string(i + 1) + ": a speed must be above 0 and at most " + number_text(hard_speeds_[i]) +
                       " [rad/s or m/s], got " + number_text(speeds[i]));
  }
  settings_.max_speeds = speeds;
  return {};
}

Reply Manipulator::set_max_cartesian_speed(double translation, double rotation) {
  constexpr double max = 100;
  if (!(translation > 0 && translation <= max && rotation > 0 && rotation <= max))
    return wrong_value("speeds must be above 0 and at most 100 [m/s, rad/s], got " + number_text(translation) + " and " +
                       number_text(rotation));
  settings_.max_translation = translation, settings_.max_rotation = rotation;
  return {};
}

Reply Manipulator::set_joint_time(double time) {
  if (Reply value = check_time(time, settings_.min_joint_time); !value.is_ok()) return value;
  settings_.joint_time = time;
  return {};
}

Reply Manipulator::set_cartesian_time(double time) {
  if (Reply value = check_time(time, settings_.min_cartesian_time); !value.is_ok()) return value;
  settings_.cartesian_time = time;
  return {};
}

Reply Manipulator::set_min_joint_time(double time) {
  if (Reply value = check_time(time, 0); !value.is_ok()) return value;
  settings_.min_joint_time = time;
  settings_.joint_time = std::max(settings_.joint_time, time);
  return {};
}

Reply Manipulator::set_min_cartesian_time(double time) {
  if (Reply value = check_time(time, 0); !value.is_ok()) return value;
  settings_.min_cartesian_time = time;
  settings_.cartesian_time = std::max(settings_.cartesian_time, time);
  return {};
}

Reply Manipulator::set_base(const Eigen::Isometry3d& base) {
  if (Reply value = check_offset(base); !value.is_ok()) return value;
  if (Reply state = may_configure("the base offset"); !state.is_ok()) return state;
  settings_.base = base;
  check_limits(false);
  return {};
}

Reply Manipulator::set_tool(const Eigen::Isometry3d& tool) {
  if (Reply value = check_offset(tool); !value.is_ok()) return value;
  if (Reply state = may_configure("the control point"); !state.is_ok()) return state;
  settings_.tool = tool;
  check_limits(false);
  return {};
}

Reply Manipulator::set_box(const std::array<Range, 3>& box) {
  if (Reply state = may_configure("Cartesian soft limits"); !state.is_ok()) return state;
  for (const Range& range : box) {
    if (!(range.low < range.high))
      return wrong_value("limits must ascend, got " + number_text(range.low) + " and " + number_text(range.high));
  }
  settings_.box = box;
  check_limits(false);
  return {};
}

Reply Manipulator::set_home(const std::vector<double>& home) {
  if (Reply value = planner().check_joints(home); !value.is_ok()) return value;
  home_ = home;
  return {};
}

}  // namespace arms
