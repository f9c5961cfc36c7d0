// Computes the velocity of the follower: towards the leader, keeping a distance, and around obstacles. Pure; any thread.
#pragma once

#include <optional>
#include <span>

#include "leader_tracker.h"

namespace follow {

struct SteeringSettings {
  double distance = 0.9;       // [m] to keep
  double distance_gain = 0.9;  // [1/s]; behind a leader at speed u the distance settles at distance + u / gain
  double bearing_gain = 1.6;   // [1/s]
  double max_speed = 0.5;      // [m/s]; it never reverses
  double max_turn = 1.0;       // [rad/s]
  double too_near = 0.4;       // [m] from the leader: stand
  double clearance = 0.5;      // [m]; other things that are nearer are avoided first
};

struct Velocity {
  double forward = 0;  // [m/s]
  double turn = 0;     // [rad/s], counter-clockwise positive
};

// Towards the leader.
Velocity towards(const Sighting& leader, const SteeringSettings& settings);

// What to do about things nearer than the clearance, by the rule of Player's "laserobstacleavoid": slower, and towards the side with more
// room. Beams of the leader do not count. Nothing when nothing else is that near.
std::optional<Velocity> around(const Scan& scan, const Sighting& leader, const SteeringSettings& settings);

}  // namespace follow
