// Features of a planar scan: straight lines and the corners between them, by splitting at the point that is furthest from the chord.
// Lengths in m, angles in rad, in the frame of the scanner. Pure; any thread.
#pragma once

#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <array>
#include <span>
#include <vector>

namespace iface {

struct ScanPoint {
  double x = 0, y = 0;
  bool is_hit = false;  // false: the beam has met nothing, or something too near
};

struct FeatureLimits {
  double distance = 0.05;  // of a point from its line at most; of two lines from their corner
  double gap = 0.3;        // between two neighbours on a line at most
  int points = 8;          // fewest of a line
  double noise = 0.01;     // standard deviation of a range, for the covariances
};

// Points in the order of the scan. A line is told as its normal from the scanner: rho its length, alpha its direction; start and end are
// the ends of the line in the order of the scan. An end is sighted when the scan goes on to what is further away or ends in a corner: then
// the line ends there, and is not hidden. A corner has a line on both sides.
void find_features(std::span<const ScanPoint> scan, const FeatureLimits& limits, RTC::Features& features);

}  // namespace iface
