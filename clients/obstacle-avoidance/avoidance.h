// The rule that keeps a robot away from obstacles, after Player's example "laserobstacleavoid". Pure; any thread.
#pragma once

#include <span>

namespace avoidance {

struct Settings {
  double distance_gain = 200;  // how much clearance counts, per metre
  double stop_distance = 0.5;  // [m] clearance at which a side counts nothing; below it the robot backs up
  double clearance_cap = 100;  // what a side counts at most: reached at stop_distance + cap / gain
  double speed_gain = 0.001;   // [m/s] per unit of both sides
  double turn_gain = 1;        // [deg/s] per unit that one side has more than the other
  double max_turn = 40;        // [deg/s]
};

struct Velocity {
  double forward = 0;  // [m/s]
  double turn = 0;     // [rad/s], counter-clockwise positive
};

// `ranges` run counter-clockwise from the right [m]; none is above max_range. An empty scan says nothing: the robot stands.
Velocity avoid(std::span<const double> ranges, double max_range, const Settings& settings);

}  // namespace avoidance
