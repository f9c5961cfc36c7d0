// An arm whose tip moves to poses: on a straight line if the joints allow it, otherwise through joint space. A new pose replaces the
// current one without a stop, so poses can be streamed. Poses are those of the tip in the frame that carries the first joint. Units: m,
// rad, s. One thread at a time.
//
// States: braked -> at rest -> on a line, on a path of the joints, or stopping -> at rest. A blocked or braked arm discards its goal.
#pragma once

#include <optional>

#include "arms/planner.h"
#include "shm/joint_part.h"

namespace arms {

class Limb {
 public:
  enum class Status { idle, braked, moving, out_of_reach, collision };

  struct Command {
    enum class Kind { none, brake, follow };
    Kind kind = Kind::none;
    std::vector<double> positions{}, velocities{};  // of follow
  };

  // Another arm; `tool` [m] from the last joint to the tip, along its z axis. False: the joints are no chain from base to tip, and nothing
  // can be commanded.
  bool begin(std::span<const shm::Joint> joints, double tool, double speed);
  bool begin(const shm::JointPart& part, double tool, double speed);
  bool is_there() const { return kinematics_.size() > 0; }

  // Of the tip; it turns three radians in the time of a metre.
  Reply set_speed(double speed);
  // Before commands and in each step: where the joints are. An arm that something blocks stays there.
  void measure(const std::vector<double>& positions, bool is_blocked = false);
  void measure(const shm::JointPart& part);
  // Without power the brakes hold as well.
  void set_power(bool is_on) { is_powered_ = is_on, settle(); }
  void set_brakes(bool are_on) { has_brakes_on_ = are_on, settle(); }
  bool is_held() const { return !is_powered_ || has_brakes_on_; }
  // Nothing is commanded until the next goal, as after a reset of the world.
  void let_go();

  // A goal that is not possible leaves the motion as it is.
  Reply go(const Eigen::Isometry3d& goal);
  // With the orientation as it is, or any other where that is not possible.
  Reply go_to_place(const Eigen::Vector3d& place);
  // On a straight line, without turning.
  Reply go_along(const Eigen::Vector3d& direction, double length);
  Reply go_home();
  // Comes to rest on its way.
  void stop();

  // Once for each sample, `dt` after the one before; what is commanded next.
  Command advance(double dt, bool was_reset = false);
  // The same of the sample that `part` has read; commands its joints.
  base::Result<void> step(shm::JointPart& part);
  Status status() const;
  Eigen::Isometry3d pose() const;  // measured

 private:
  using Positions = std::vector<double>;
  enum class Way { none, standing, line, joints };
  struct Twist {
    Eigen::Vector3d linear{0, 0, 0}, angular{0, 0, 0};
    bool is_zero() const { return linear.isZero(0) && angular.isZero(0); }
  };
  Reply may_move() const;
  Eigen::Isometry3d tip(const Positions& positions) const { return kinematics_.tip(positions) * tool_; }
  Reply start(const Eigen::Isometry3d& goal);
  Reply go_by_joints(const Positions& goal);
  void come_to_rest() { is_stopping_ = way_ == Way::line || way_ == Way::joints; }
  bool is_line_possible(const Eigen::Isometry3d& goal) const;
  void start_from_here();
  void settle();
  void stand();
  void advance_line(double dt);
  void advance_joints(double dt);
  bool move_tip(const Twist& twist, double dt);

  ArmKinematics kinematics_;
  ArmSettings settings_;
  Eigen::Isometry3d tool_ = Eigen::Isometry3d::Identity();
  Positions home_;
  double speed_ = 0.25;
  bool is_powered_ = true, has_brakes_on_ = false, was_held_ = false, is_out_of_reach_ = false, has_collided_ = false;
  bool must_brake_ = false;  // in the next step

  Positions measured_, commanded_, velocities_;
  Way way_ = Way::none;
  std::optional<Eigen::Isometry3d> asked_;  // of this motion; a pose that is sent again changes nothing
  std::optional<Eigen::Isometry3d> refused_;
  std::optional<Eigen::Isometry3d> goal_;  // of the line
  Twist twist_;                            // of the tip as commanded
  std::optional<Motion> motion_;           // of the joints
  double time_ = 0, pace_ = 1;             // on it
  bool is_stopping_ = false;
  std::optional<Positions> next_;  // a goal of the joints, once it has come to rest
};

// Commands the joints. Fails when a command is rejected.
base::Result<void> command(const Limb::Command& command, shm::JointPart& part);

}  // namespace arms
