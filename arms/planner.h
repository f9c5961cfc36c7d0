// Plans the motions of an arm: joint space, straight lines and arcs, within the limits of its settings. Units: rad or m for joints, m, s.
// Errors are replies with the return codes of the JARA specification. Values; any thread.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "arms/arm_kinematics.h"
#include "arms/motion.h"

namespace arms {

enum class Answer { ok = 0, fault = -1, wrong_state = -2, wrong_value = -3, servo_off = -4, queue_full = -5, not_implemented = -6 };

struct Reply {
  Answer answer = Answer::ok;
  std::string comment;
  bool is_ok() const { return answer == Answer::ok; }
};

Reply wrong_value(std::string comment);

struct Range {
  double low = 0, high = 0;
  bool contains(double value, double tolerance = 0) const { return value >= low - tolerance && value <= high + tolerance; }
};

struct ArmSettings {
  std::vector<Range> limits;                                          // soft limits of the joints
  std::vector<double> max_speeds;                                     // of the joints [rad/s or m/s]
  std::array<Range, 3> box{{{-1e3, 1e3}, {-1e3, 1e3}, {-1e3, 1e3}}};  // Cartesian soft limits of the control point
  double max_translation = 0.5, max_rotation = 1.5;                   // [m/s], [rad/s]
  double joint_ratio = 0.5, cartesian_ratio = 0.5;                    // of the highest speeds
  double joint_time = 0.5, cartesian_time = 0.5;                      // [s] from rest to the set speed
  double min_joint_time = 0, min_cartesian_time = 0;
  int command_cycle_ms = 1;                                // of low-level commands
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();  // of the arm, in the robot's frame
  Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();  // control point in the frame of the flange
};

struct Plan {
  Reply reply;
  std::optional<Motion> motion;  // when the reply is ok
};

class Planner {
 public:
  Planner() = default;
  Planner(ArmKinematics kinematics, ArmSettings settings) : kinematics_(std::move(kinematics)), settings_(std::move(settings)) {}

  std::size_t axes() const { return settings_.limits.size(); }
  // Of the control point, in the robot's frame.
  Eigen::Isometry3d pose(std::span<const double> positions) const;
  Reply check_joints(std::span<const double> goal) const;

  // From joint positions at rest. A relative Cartesian goal is an offset in the robot's frame; its rotation multiplies from the left.
  Plan to_joints(const std::vector<double>& from, const std::vector<double>& goal, bool is_relative) const;
  Plan to_pose(const std::vector<double>& from, const Eigen::Isometry3d& goal, bool is_relative) const;
  Plan along_line(const std::vector<double>& from, const Eigen::Isometry3d& goal, bool is_relative) const;
  // The orientation turns evenly from the start to the goal; that of `via` is not used.
  Plan along_arc(const std::vector<double>& from, const Eigen::Isometry3d& via, const Eigen::Isometry3d& goal, bool is_relative) const;

 private:
  struct Way {
    double length = 0, turn = 0;  // [m], [rad]
    std::vector<Eigen::Isometry3d> poses;
  };
  Reply check_pose(const Eigen::Isometry3d& pose) const;
  Reply check_cartesian_speed() const;
  Eigen::Isometry3d goal_of(const std::vector<double>& from, const Eigen::Isometry3d& goal, bool is_relative) const;
  std::optional<std::vector<double>> joints_at(const Eigen::Isometry3d& pose, std::span<const double> from, bool is_path) const;
  int points_of(double length, double turn) const;
  Plan follow(const std::vector<double>& from, const Way& way) const;

  ArmKinematics kinematics_;
  ArmSettings settings_;
};

// Whether a matrix is orthonormal and right-handed.
bool is_rotation(const Eigen::Matrix3d& matrix);
std::string number_text(double value);

}  // namespace arms
