// The controller of one joint: turns a command into the motor of the next step. SI units: [rad], [rad/s], [N m] for joints that turn, [m],
// [m/s], [N] for those that slide. Values; one thread at a time.
//
// Position and velocity are controlled by a spring and a damper that are one row of the solver: with K = dt p + d the row asks for the
// velocity (p (target - position) + d target_velocity + effort) / K and gives way by 1 / K. What comes out is the spring and damper at the
// end of the step, so that any gains are stable at any step, and at rest the same. The integral, and the effort that gravity needs, are
// added to the effort. A target that jumps is approached with a trapezoid of speed, at the joint's highest velocity at most; where the
// spring asks for more than that, the row asks for the highest velocity and has the effort of the spring as its limit.
#pragma once

#include "physics/hash.h"
#include "physics/physics.h"

namespace sim {

struct JointGains {
  double p = 0, i = 0, d = 0;                   // effort for each unit of position, its integral, velocity
  double i_low = -infinite, i_high = infinite;  // of the integral's effort
  double offset = 0;                            // effort that is always added
};

// For a joint without gains of its own: critically damped at 8 Hz for what it has to move [kg m^2 or kg], with an integral of 0.4 s.
JointGains derived_gains(double inertia);

enum class JointMode : std::uint32_t { none, position, velocity, effort, free, brake, disabled };
enum class JointStatus : std::uint32_t { idle, moving, braked, stalled };

struct JointOrder {
  JointMode mode = JointMode::none;
  // Velocity and effort are fed forward; the effort of a velocity is the highest that it may use, 0: that of the setup.
  double value = 0, velocity = 0, effort = 0;
  bool is_compensated = false;  // gravity, whatever the setup says
  double gain = 1;              // times the gains of the setup, of a position or velocity
};

class JointServo {
 public:
  struct Setup {
    JointGains gains;
    double low = -infinite, high = infinite;
    double velocity = 2, effort = 100;  // highest
    bool slides = false;
    bool is_compensated = false;  // gravity, while position or velocity are controlled
    bool goes_round = false;      // its position is known within a turn
    bool turns_as_told = false;   // a velocity is kept by all the effort, without spring and damper
  };

  explicit JointServo(const Setup& setup) : setup_(setup) {}
  const Setup& setup() const { return setup_; }

  // From the next step on. False: the value was outside the limits, and the nearest one counts.
  bool take(const JointOrder& order, const JointState& now);
  bool is_active() const { return mode_ != JointMode::none; }
  // By a speed or an effort that was asked for.
  bool is_turning() const { return mode_ == JointMode::velocity || mode_ == JointMode::effort; }
  bool wants_gravity() const;

  // The part of its highest effort that the motor has left, 0 to 1. Brakes keep theirs. 1 after a reset.
  void set_strength(double strength) { strength_ = strength; }

  // The motor of the next step; `gravity`: the effort that holds the joint against gravity. A row that is no number disables the joint.
  JointRow row(const JointState& now, double gravity, double dt);
  // After the step.
  void follow(const JointState& now, double dt);

  JointMode mode() const { return mode_; }
  JointStatus status() const { return status_; }
  double target() const;
  double effort() const { return effort_; }  // in the last step
  void reset();
  void add_to(StateHash& hash) const;

 private:
  void move_target(const JointState& now, double dt);
  JointRow spring(const JointState& now, double gravity, double dt) const;
  JointRow brake(const JointState& now, double dt);
  void integrate(const JointState& now, double dt);
  double clamped(double position) const;
  double way_to(double target, const JointState& now) const;  // the shorter one of a joint that goes round
  double stiffness() const { return order_.gain * setup_.gains.p; }
  double motor_effort() const { return strength_ * setup_.effort; }
  double max_effort() const;  // now

  Setup setup_;
  JointMode mode_ = JointMode::none;
  JointOrder order_;
  double reference_ = 0, reference_velocity_ = 0;  // that the spring follows now
  double since_order_ = 0;                         // [s]
  double integral_ = 0;                            // effort
  bool is_latched_ = false;                        // the brake is a spring to the reference
  bool is_far_ = false;                            // the target has jumped: on the way with a trapezoid of speed
  double stalled_for_ = 0, still_for_ = 0;         // [s]
  double effort_ = 0;
  double strength_ = 1;
  JointStatus status_ = JointStatus::idle;
  JointRow row_;
};

}  // namespace sim
