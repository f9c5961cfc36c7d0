// Tracks the leader by a laser: beams that hit the same thing form a cluster, and the leader is the cluster where it was before. Pure; one
// thread at a time.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace follow {

struct Point {
  double x = 0, y = 0;  // [m]
};
struct Pose {
  double x = 0, y = 0, a = 0;  // [m, rad]
};

struct Scan {
  double min_angle = 0, angle_step = 0;  // [rad], counter-clockwise
  double max_range = 0;                  // [m]; beams as long have hit nothing
  std::span<const float> ranges;         // [m]
};

struct Cluster {
  Point centre;                     // mean of the points, in the robot's frame
  double width = 0;                 // between the first and the last point [m]
  std::size_t first = 0, last = 0;  // beams
};

// In the frame of the robot that carries the scanner at `mount`. Successive points nearer than `jump` belong together.
std::vector<Cluster> find_clusters(const Scan& scan, const Pose& mount, double jump);

struct TrackerSettings {
  double jump = 0.15;                       // [m] between successive points of one thing
  double min_width = 0.2, max_width = 0.6;  // [m] of what may be the leader when it is first seen
  double max_bearing = 1.047;               // [rad] to either side, when it is first seen
  double gate = 0.5;                        // [m] that it may be away from where it was
  double widest = 0.8;                      // [m] of what may be the leader later: walls are wider
  double max_speed = 0.5;                   // [m/s] by which the gate grows while it is not seen
  double forget = 5;                        // [s] after which any leader will do
  // More than the robot can drive [m] or turn [rad] from one scan to the next, besides what max_speed explains: the odometry has been set,
  // or the world is another one.
  double odometry_jump = 0.5;
};

struct Sighting {
  double distance = 0, bearing = 0;  // of its centre, from the robot's [m, rad]
  std::size_t first = 0, last = 0;   // its beams
};

class LeaderTracker {
 public:
  explicit LeaderTracker(const TrackerSettings& settings = {}) : settings_(settings) {}

  // `odometry` and `time` [s] are those of the scan. Nothing when the leader is not in it. When the odometry jumps, or time goes back, the
  // place of the leader means nothing any more: any leader will do.
  std::optional<Sighting> update(const Scan& scan, const Pose& mount, const Pose& odometry, double time);
  // [s] since it was seen last; nothing when it never was.
  std::optional<double> unseen(double time) const;

 private:
  bool has_jumped(const Pose& odometry, double time) const;

  TrackerSettings settings_;
  std::optional<Point> place_;  // in the frame of the odometry
  double seen_at_ = 0;
  Pose last_odometry_;
  std::optional<double> last_time_;  // of the scan before
};

}  // namespace follow
