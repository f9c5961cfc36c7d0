// The rule by which a robot brings a box to a door: straight on until it is there, straight back, and stopped while something is in its
// way. Pure; any thread.
#pragma once

#include <span>

namespace warehouse {

struct Settings {
  double distance = 6;       // [m] from the start to the door
  double speed = 0.4;        // [m/s]
  double stop_distance = 1;  // [m] nothing is to be nearer in the lane ahead
  double lane_width = 0.5;   // [m]
  double start_time = 0;     // [s] since the activation
};

enum class Stage { waiting, bringing, returning, done };

// By its odometry, which was 0 at the start [m, rad].
struct Place {
  double x = 0, y = 0, heading = 0;
};

struct Velocity {
  double forward = 0;  // [m/s]
  double turn = 0;     // [rad/s], counter-clockwise positive
};

// The stage that follows at this place and time [s].
Stage next_stage(Stage stage, const Place& place, double time, const Settings& settings);

// Keeps to the line on which the robot started, and slows down before the end of the way.
Velocity drive(Stage stage, const Place& place, const Settings& settings);

// Something in the lane ahead is nearer than stop_distance. `ranges` run counter-clockwise from `first_angle` [rad, m].
bool is_blocked(std::span<const double> ranges, double first_angle, double step, const Settings& settings);

}  // namespace warehouse
