#include "physics/joint_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sim {
namespace {

constexpr double near_stop = 1e-4;           // [rad] or [m] that targets keep away from stops
constexpr double hardly_any = 1e-5;          // [rad] or [m] of error that nothing is done about
constexpr double arrived = 1e-3;             // [rad] or [m] from the target
constexpr double still = 1e-3;               // [rad/s] or [m/s]
constexpr double max_ahead = 0.05;           // [s] that a target goes on without a new command
constexpr double furthest_ahead = 1;         // [rad] within a turn
constexpr double time_to_full_speed = 0.25;  // [s] of a target that jumped
constexpr double far = 0.05;                 // [s] of the way at full speed: further is a jump
constexpr double time_to_settle = 0.5;       // [s] that a joint stands beside its target before it has arrived
constexpr double time_to_stall = 0.5;        // [s]
constexpr double brake_strength = 2;         // times the highest effort
constexpr double brake_stiffness = 10;       // times the gains
constexpr double as_told = 1e-6;             // [rad/s / N m] or [m/s / N] by which a motor that turns as told gives way
constexpr double hard = 100;                 // times the stiffness of the spring: where the highest velocity is kept

}  // namespace

JointGains derived_gains(double inertia) {
  constexpr double frequency = 2 * std::numbers::pi * 8;  // [rad/s]
  constexpr double integral_time = 0.4;                   // [s]
  JointGains gains;
  gains.p = inertia * frequency * frequency;
  gains.d = 2 * inertia * frequency;
  gains.i = gains.p / integral_time;
  return gains;
}

double JointServo::clamped(double position) const {
  const double margin = std::min(near_stop, 0.1 * (setup_.high - setup_.low));
  return std::clamp(position, setup_.low + margin, setup_.high - margin);
}

double JointServo::way_to(double target, const JointState& now) const {
  const double way = target - now.position;
  return setup_.goes_round ? std::remainder(way, 2 * std::numbers::pi) : way;
}

double JointServo::max_effort() const {
  const bool is_limited = mode_ == JointMode::velocity && order_.effort > 0;
  return is_limited ? std::min(motor_effort(), order_.effort) : motor_effort();
}

bool JointServo::take(const JointOrder& order, const JointState& now) {
  if (mode_ == JointMode::disabled) return true;
  const bool was_controlled = mode_ == JointMode::position || mode_ == JointMode::velocity;
  const bool is_controlled = order.mode == JointMode::position || order.mode == JointMode::velocity;
  if (is_controlled && !was_controlled) reference_ = clamped(now.position), reference_velocity_ = integral_ = stalled_for_ = 0;
  if (order.mode == JointMode::brake && mode_ != JointMode::brake) {
    is_latched_ = was_controlled && std::abs(now.velocity) < 10 * still && setup_.gains.p > 0;
    reference_ = now.position + (is_latched_ ? effort_ / (brake_stiffness * setup_.gains.p) : 0);
  }
  if (order.mode == JointMode::position && mode_ == JointMode::velocity) reference_ = clamped(now.position);
  const bool was_position = mode_ == JointMode::position;
  const double old_value = order_.value;
  mode_ = order.mode;
  order_ = order;
  since_order_ = 0;
  bool is_within = true;
  if (mode_ == JointMode::position) {
    constexpr double rounding = 1e-9;
    is_within = order.value >= setup_.low - rounding && order.value <= setup_.high + rounding;
    order_.value = clamped(order.value);
    if (!was_position || order_.value != old_value) is_far_ = std::abs(order_.value - reference_) > far * setup_.velocity;
  } else if (mode_ == JointMode::velocity || mode_ == JointMode::effort) {
    const double most = mode_ == JointMode::velocity ? setup_.velocity : setup_.effort;
    is_within = std::abs(order.value) <= most;
    order_.value = std::clamp(order.value, -most, most);
  }
  return is_within;
}

bool JointServo::wants_gravity() const {
  if (order_.is_compensated) return mode_ == JointMode::position || mode_ == JointMode::velocity || mode_ == JointMode::effort;
  return setup_.is_compensated && (mode_ == JointMode::position || mode_ == JointMode::velocity);
}

// Where the spring is to pull, at the end of the step.
void JointServo::move_target(const JointState& now, double dt) {
  const double before = reference_;
  if (mode_ == JointMode::velocity) {
    // Not further ahead than the motor can pull, nor than is known of a joint that goes round.
    const double ahead = stiffness() > 0 && !setup_.turns_as_told ? max_effort() / stiffness() : 0;
    // Beyond a stop as well, so that it presses with all its effort.
    const double lead = std::min(ahead + std::abs(order_.value) * dt, setup_.goes_round ? furthest_ahead : infinite);
    if (setup_.goes_round) reference_ = now.position + way_to(reference_, now);
    reference_ = std::clamp(reference_ + order_.value * dt, now.position - lead, now.position + lead);
    reference_velocity_ = order_.value;
    return;
  }
  if (order_.velocity != 0) {
    // A point of a path, which the commander interpolates.
    reference_ = clamped(order_.value + order_.velocity * std::min(since_order_, max_ahead));
    reference_velocity_ = since_order_ < max_ahead ? order_.velocity : 0;
    return;
  }
  const double missing = order_.value - reference_;
  double speed = setup_.velocity;
  if (is_far_) {
    const double acceleration = setup_.velocity / time_to_full_speed;
    speed = std::min({speed, std::abs(reference_velocity_) + acceleration * dt,
                      std::sqrt(2 * acceleration * std::abs(missing)) + acceleration * dt / 2});
  }
  reference_ = std::abs(missing) <= speed * dt ? order_.value : reference_ + std::copysign(speed * dt, missing);
  reference_velocity_ = (reference_ - before) / dt;
}

JointRow JointServo::spring(const JointState& now, double gravity, double dt) const {
  const JointGains& gains = setup_.gains;
  JointRow row;
  const double p = this->stiffness(), d = order_.gain * gains.d, stiffness = dt * p + d;
  const double most = max_effort();
  const double added = (mode_ == JointMode::position ? order_.effort : 0) + gains.offset + integral_ + gravity;
  if (!(stiffness > 0)) {
    row.push = std::clamp(added, -most, most);
    return row;
  }
  if (setup_.turns_as_told && mode_ == JointMode::velocity) {
    row.most = most;
    row.give = as_told;
    row.velocity = order_.value;
    return row;
  }
  const double speed = std::max(setup_.velocity, std::abs(reference_velocity_));
  const double wanted = (p * way_to(reference_, now) + d * reference_velocity_) / stiffness;
  row.most = most;
  row.give = 1 / stiffness;
  row.velocity = wanted + added / stiffness;
  if (std::abs(wanted) > speed) {
    row.most = std::min(most, std::abs(stiffness * wanted) + std::abs(added));
    row.give = 1 / (hard * stiffness);
    row.velocity = std::copysign(speed, wanted);
  }
  return row;
}

// Holds where it stood still first. One that was held already is held by a stiff spring that pulls as its controller did: what fingers hold
// they go on to press.
JointRow JointServo::brake(const JointState& now, double dt) {
  JointRow row;
  row.most = brake_strength * setup_.effort;
  if (is_latched_) {
    const double p = brake_stiffness * setup_.gains.p, stiffness = dt * p + brake_stiffness * setup_.gains.d;
    row.velocity = p * way_to(reference_, now) / stiffness;
    row.give = 1 / stiffness;
    return row;
  }
  if (std::abs(now.velocity) > 10 * still) reference_ = now.position;
  row.velocity = 0.2 * way_to(reference_, now) / dt;
  row.give = 1e-9;
  return row;
}

JointRow JointServo::row(const JointState& now, double gravity, double dt) {
  JointRow row;
  switch (mode_) {
    case JointMode::position:
    case JointMode::velocity:
      move_target(now, dt);
      row = spring(now, gravity, dt);
      // The last: it has become too weak for what it held while the model slept.
      row.keeps_awake = reference_velocity_ != 0 || std::abs(way_to(reference_, now)) > hardly_any || std::abs(effort_) > max_effort();
      break;
    case JointMode::effort:
      row.push = std::clamp(order_.value + order_.effort + gravity, -motor_effort(), motor_effort());
      row.keeps_awake = row.push != 0;
      break;
    case JointMode::brake:
      row = brake(now, dt);
      break;
    case JointMode::none:
    case JointMode::free:
    case JointMode::disabled:
      break;
  }
  since_order_ += dt;
  if (!std::isfinite(row.velocity) || !std::isfinite(row.push) || !(row.give >= 0) || !(row.most >= 0)) {
    mode_ = JointMode::disabled;
    row = JointRow();
  }
  return row_ = row;
}

void JointServo::integrate(const JointState& now, double dt) {
  const double error = way_to(reference_, now);
  const bool is_saturated = std::abs(effort_) >= 0.99 * max_effort() && error * effort_ > 0;
  if (setup_.gains.i == 0 || reference_velocity_ != 0 || std::abs(error) <= hardly_any || is_saturated) return;
  const double low = std::max(setup_.gains.i_low, -motor_effort()), high = std::min(setup_.gains.i_high, motor_effort());
  integral_ = std::clamp(integral_ + order_.gain * setup_.gains.i * error * dt, std::min(low, high), std::max(low, high));
}

void JointServo::follow(const JointState& now, double dt) {
  // What the row did, from what came of it. A model that sleeps has no velocity at all, and holds as it did.
  const bool is_asleep = row_.most > 0 && now.velocity == 0;
  const double of_row = std::clamp((row_.velocity - now.velocity) / std::max(row_.give, 1e-9), -row_.most, row_.most);
  if (!is_asleep) effort_ = row_.push + of_row;
  const bool is_controlled = mode_ == JointMode::position || mode_ == JointMode::velocity;
  if (is_controlled) integrate(now, dt);
  const bool is_slow = std::abs(now.velocity) < std::max(0.01 * setup_.velocity, still);
  const bool is_at_limit = std::abs(effort_) >= 0.99 * max_effort();
  stalled_for_ = is_controlled && is_slow && is_at_limit ? stalled_for_ + dt : 0;
  const bool is_still = std::abs(now.velocity) < 10 * still;
  still_for_ = is_still ? still_for_ + dt : 0;
  const bool is_close = std::abs(way_to(order_.value, now)) < arrived || still_for_ >= time_to_settle;
  const bool has_arrived = is_still && (mode_ != JointMode::position || (reference_ == order_.value && is_close));
  if (mode_ == JointMode::brake) {
    status_ = JointStatus::braked;
  } else if (stalled_for_ >= time_to_stall) {
    status_ = JointStatus::stalled;
  } else {
    status_ = has_arrived && !(mode_ == JointMode::velocity && order_.value != 0) ? JointStatus::idle : JointStatus::moving;
  }
}

double JointServo::target() const {
  switch (mode_) {
    case JointMode::position:
    case JointMode::velocity:
    case JointMode::effort:
      return order_.value;
    case JointMode::brake:
      return reference_;
    default:
      return 0;
  }
}

void JointServo::reset() { *this = JointServo(setup_); }

void JointServo::add_to(StateHash& hash) const {
  hash.add_all(static_cast<std::uint64_t>(mode_), order_.value, order_.velocity, order_.effort, reference_, reference_velocity_,
               since_order_, integral_, stalled_for_, still_for_, effort_, std::uint64_t{is_latched_}, std::uint64_t{is_far_});
  if (strength_ != 1) hash.add(strength_);
  if (order_.gain != 1) hash.add(order_.gain);
}

}  // namespace sim
