// State of a JARA manipulator, independent of CORBA: servo, alarms, settings, and a queue of motions, which advance with simulated time.
// Return codes are those of the JARA specification. Units: rad or m, s. One thread at a time: the component keeps a lock around it.
//
// States: servo off -> at rest -> moving -> paused or stopping -> at rest. An alarm or servo off discards the queue from every state. A
// motion is planned on a copy (planning()), without the lock. add() fails if the queue was discarded in the meantime.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "arms/planner.h"

namespace arms {

struct FingerCommand {
  enum class Kind { close, move, hold };
  Kind kind = Kind::hold;
  double ratio = 0;  // of move: 0 closed .. 1 open
  bool operator==(const FingerCommand&) const = default;
};

class Manipulator {
 public:
  struct Alarm {
    std::uint32_t code = 0;  // of the JARA text
    std::string description;
    bool is_fault = false;  // cannot be cleared while its reason lasts; the servo is off
  };
  struct Feedback {
    std::vector<double> positions;
    double finger_ratio = 0;  // 0 closed .. 1 open
    bool are_fingers_still = true;
    std::optional<std::size_t> overloaded;  // a joint at its highest effort that does not move
  };
  struct Target {
    std::vector<double> positions, velocities;
  };
  // What a motion is planned with.
  struct Planning {
    Planner planner;
    std::vector<double> from;
    std::uint64_t drops = 0;
  };
  static constexpr std::size_t max_motions = 16;  // that wait or move
  static constexpr std::uint32_t has_servo = 1, is_moving = 2, has_alarm = 4, is_full = 8, is_paused = 16;

  // Another arm, with the usual settings: servo off, nothing queued.
  void begin(std::span<const shm::Joint> joints, bool has_fingers, double speed_ratio, int command_cycle_ms = 1);
  // The same arm after a reset of the world: servo off, nothing queued, no alarm but that of a signal. Settings stay.
  void restart();

  std::size_t axes() const { return hold_.size(); }

  // --- each tick
  void feed(Feedback feedback);
  // The signal of an emergency stop: an alarm that lasts as long as the signal, and no servo.
  void set_emergency(bool is_on);
  // Moves on by simulated time. Nothing: the servo is off, the brakes hold.
  std::optional<Target> advance(double dt);
  std::optional<FingerCommand> take_finger_command();
  // Low level: positions to reach in one command cycle. Fails when they are not valid, the servo is off or motions are queued.
  Reply follow(const std::vector<double>& positions);

  // --- common level
  std::uint32_t state() const;
  const Feedback& feedback() const { return feedback_; }
  bool has_fingers() const { return has_fingers_; }
  const std::vector<Alarm>& alarms() const { return alarms_; }
  Reply clear_alarms();
  Reply set_servo(bool is_on);
  Reply set_soft_limits(const std::vector<Range>& limits);

  // --- middle level
  std::variant<Planning, Reply> planning() const;  // a reply: no motion is accepted now
  Reply add(Motion motion, std::uint64_t drops);
  // Both, for one thread.
  Reply move(const std::function<Plan(const Planner& planner, const std::vector<double>& from)>& plan);
  Reply move_fingers(const FingerCommand& command);
  Reply pause();
  Reply resume();
  Reply stop();
  const ArmSettings& settings() const { return settings_; }
  Planner planner() const { return {kinematics_, settings_}; }
  Eigen::Isometry3d pose() const { return settings_.base * kinematics_.tip(feedback_.positions) * settings_.tool; }
  const std::vector<double>& home() const { return home_; }
  Reply set_joint_speed(std::uint32_t percent);
  Reply set_cartesian_speed(std::uint32_t percent);
  Reply set_max_joint_speeds(const std::vector<double>& speeds);
  Reply set_max_cartesian_speed(double translation, double rotation);
  Reply set_joint_time(double time);
  Reply set_cartesian_time(double time);
  Reply set_min_joint_time(double time);
  Reply set_min_cartesian_time(double time);
  Reply set_base(const Eigen::Isometry3d& base);
  Reply set_tool(const Eigen::Isometry3d& tool);
  Reply set_box(const std::array<Range, 3>& box);
  Reply set_home(const std::vector<double>& home);

 private:
  using Step = std::variant<Motion, FingerCommand>;
  struct Stopping {
    double from = 0, pace = 0, time = 0;  // time on the motion and pace at the start; [s] since then
  };
  Reply may_move() const;
  Reply may_configure(const char* what) const;
  void raise(std::uint32_t code, std::string description);
  void check_limits(bool is_alarm);
  void check_speeds(double dt);
  void hold_here();
  void drop();
  bool advance_fingers(double dt);
  void advance_low_level(double dt, Target& target);
  void advance_motion(double dt, Target& target);
  double end_of_stop() const;

  ArmKinematics kinematics_;
  ArmSettings settings_;
  std::vector<Range> hard_limits_;
  std::vector<double> hard_speeds_, home_;
  bool has_fingers_ = false;
  Feedback feedback_;
  std::vector<bool> is_outside_;  // joints, then the control point
  std::vector<Alarm> alarms_;
  bool is_servo_on_ = false, is_paused_ = false, is_emergency_ = false, is_too_fast_ = false;
  std::vector<double> measured_from_;  // positions from which speeds are measured
  double measured_for_ = 0;            // [s]
  std::optional<Stopping> stopping_;
  std::deque<Step> queue_;
  std::uint64_t drops_ = 0;
  double time_ = 0;                // on the first motion of the queue [s]
  double pace_ = 1;                // of that time; 0 at rest
  std::vector<double> hold_;       // commanded positions
  std::vector<double> planned_;    // where the queue ends
  std::vector<double> low_level_;  // goal of follow(); empty: none
  double low_level_left_ = 0;      // [s] until that goal
  std::optional<FingerCommand> finger_command_;
  std::optional<double> finger_time_;  // [s] since the first step of the queue was given to the fingers
};

}  // namespace arms
