// Angles [rad]. Any thread.
#pragma once

#include <cmath>
#include <numbers>

namespace sim {

// The same direction within [-pi, pi]. Nearly all angles are within already, and the division is slow.
inline double wrapped(double angle) { return std::abs(angle) < std::numbers::pi ? angle : std::remainder(angle, 2 * std::numbers::pi); }

}  // namespace sim
