// Some joints of a joints iface that one component or device commands, in an order of its own. Positions are reached by a trapezoid of
// speed, which this class steps; the simulator's controllers follow it. Units: rad or m, N m or N, s. One thread at a time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shm/client.h"

namespace shm {

// The part of its gains that a joint is controlled with, in percent: in the mode of a command, plus 1; 0 there stands for 100.
inline constexpr std::uint32_t joint_gain_shift = 16, max_joint_gain = 200;

// One coordinate on its way to a goal: speed rises and falls evenly, a new goal on the way is taken from there.
struct JointMotion {
  double position = 0, velocity = 0, goal = 0;
  double speed = 1, acceleration = 1;  // highest; positive
  void advance(double dt);
  bool has_arrived() const { return position == goal && velocity == 0; }
};

class JointPart {
 public:
  // The joints with these names, separated by commas; all of them when there are none. Fails with a line that lists what there is.
  base::Result<void> choose(const Iface& iface, std::string_view names);
  void clear() { members_.clear(); }
  std::size_t size() const { return members_.size(); }
  const Joint& joint(std::size_t i) const { return members_[i].joint; }
  // As of the last read().
  const JointState& state(std::size_t i) const { return members_[i].state; }

  bool has_states() const { return time_ns_ >= 0; }
  // No time passes until the next sample: dt() is 0 with it. States stay.
  void start_anew() { starts_anew_ = true; }
  // [s] of simulated time between the last two samples.
  double dt() const { return dt_; }
  // Whether the world was reset between them.
  bool was_reset() const { return was_reset_; }

  // Takes the sample that the iface has, and steps what moves by the time since the one before. After a reset of the world nothing is
  // commanded any more.
  void read(const Iface& iface);
  // Commands what has changed, all in one command. Fails when the simulator does not take it.
  base::Result<void> send(Iface& iface);

  // Goals outside of the limits fail with a line, and nothing changes.
  base::Result<void> move(std::size_t i, double goal);
  base::Result<void> turn(std::size_t i, double velocity, double max_effort = 0);  // 0: the joint's own
  base::Result<void> push(std::size_t i, double effort);
  // Of a path that somebody else interpolates: a position with its velocity and an effort that is added.
  base::Result<void> follow(std::size_t i, double position, double velocity, double effort);
  void brake(std::size_t i);
  void free(std::size_t i);  // it hangs
  // Of position and velocity from the next command on; 0 to max_joint_gain [%].
  base::Result<void> set_gain(std::size_t i, double percent);
  void hold(std::size_t i);  // where it is now
  base::Result<void> set_speed(std::size_t i, double speed);
  base::Result<void> set_acceleration(std::size_t i, double acceleration);
  bool is_moving(std::size_t i) const;
  bool is_commanded(std::size_t i) const { return members_[i].mode != RTMSIM_JOINT_NONE; }
  bool is_held(std::size_t i) const { return members_[i].mode == RTMSIM_JOINT_BRAKE; }

 private:
  struct Member {
    Joint joint{};
    JointState state{};
    JointMotion motion;
    std::uint32_t mode = RTMSIM_JOINT_NONE, gain = 100;
    double value = 0, velocity = 0, effort = 0;
    bool is_path = false;  // the position is not a goal of the motion
    bool has_changed = false;
  };
  std::string text_of(std::size_t i) const;
  void order(Member& member, std::uint32_t mode, double value, double effort = 0);

  std::vector<Member> members_;
  std::vector<double> values_;
  double dt_ = 0;
  bool was_reset_ = false;
  std::int64_t time_ns_ = -1;
  bool starts_anew_ = false;
  std::uint32_t resets_ = 0;
};

}  // namespace shm
