// Controls a wheeled robot to a pose of its odometry, or to a heading: computes the next velocity from the current pose. Pure; one thread
// at a time.
//
// Each sample of the odometry gives the next velocity, so it needs no clock, and a simulator on its own knows only velocities. In 3D the
// simulator has pose commands of its own.
#pragma once

#include "shm/iface_types.h"

namespace shm {

struct PlanarPose {
  double x = 0, y = 0, a = 0;  // [m], [m], [rad]; of a velocity [m/s], [m/s], [rad/s]
};

// Of the commands; all greater than 0.
struct DriveLimits {
  double speed = 0.4, turn = 1;                      // [m/s], [rad/s]
  double acceleration = 0.5, turn_acceleration = 2;  // [m/s^2], [rad/s^2]: how hard it brakes for the goal
  double rate = 10;                                  // of the odometry [Hz]
  bool is_holonomic = false;
};
// The same within what a robot can do.
DriveLimits within(DriveLimits wanted, const Position2dInfo& robot);

// One way to one goal. A robot that can't move sideways turns towards the goal, drives there and turns to the heading that is wanted; a
// holonomic one does all at once. Speeds are proportional to what is left, within the limits; the factors are at most 1.5/s (turning: 2/s),
// less where the brakes would be too weak for it or the odometry comes too rarely (0.3 times its rate). It arrives within 1 cm and 0.01 rad
// by the odometry, and has arrived then, wherever it is moved later. Obstacles are not looked for.
class PoseControl {
 public:
  // Forward while turning by more than this [rad] makes no sense.
  static constexpr double straight = 0.5;
  static constexpr double near_enough = 0.01, straight_enough = 0.01;  // [m], [rad]

  PoseControl(const PlanarPose& goal, const DriveLimits& limits) : goal_(goal), limits_(limits) {}

  // The velocity to command, in the robot's frame. Zero once it has arrived.
  PlanarPose next(const PlanarPose& odometry);
  bool has_arrived() const { return phase_ == Phase::arrived; }

 private:
  enum class Phase { turn, drive, turn_to_heading, arrived };
  PlanarPose next_holonomic(double ahead, double beside, double heading_error);
  PlanarPose turn_to_heading(double heading_error);

  PlanarPose goal_;
  DriveLimits limits_;
  Phase phase_ = Phase::turn;
};

// The turn rate [rad/s] that brings the robot from one heading to the other by the shorter way.
double turn_towards(double heading, double wanted, const DriveLimits& limits);

}  // namespace shm
