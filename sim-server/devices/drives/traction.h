// Compares what the wheels of a robot do with what the robot does: whether it is stalled, and whether its wheels slip. A value; one thread
// at a time.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>

#include "devices/drives/drive_train.h"

namespace sim {

class Traction {
 public:
  // `separation` of the wheels [m]. Skid-steered wheels must slip to turn: only what they roll forward is looked at.
  Traction(double separation, bool is_skid) : separation_(separation), is_skid_(is_skid) {}

  // After each step: vx, vy and va that the motors follow, and what the encoders saw. True when it wants to know where the robot is.
  bool follow(const std::array<double, 3>& wanted, const Travel& rolled, double dt);
  // Then. Returns a line when the wheels have slipped for three seconds; once, until they grip again.
  std::string look(const Eigen::Isometry3d& pose);
  // For half a second it has moved less than a fifth of what the motors want.
  bool is_stalled() const { return stalled_blocks_ >= 2; }
  void restart();

 private:
  struct Path {
    double forward = 0, turn = 0, aside = 0;  // [m], [rad], [m]
  };
  double length(const Path& path) const;
  std::string close_block(const Path& moved);

  double separation_;
  bool is_skid_;
  Eigen::Isometry3d block_start_ = Eigen::Isometry3d::Identity();
  bool has_start_ = false;
  double block_time_ = 0;  // [s]
  Path wanted_, rolled_;
  Path slipped_rolled_, slipped_moved_;  // since it slips
  int stalled_blocks_ = 0, slipped_blocks_ = 0;
};

}  // namespace sim
