// A path through way points, driven at one speed: straight pieces, with rounded corners or turns on the spot. It is known in advance for
// all times, so a model that follows it has the same pose in every run. A value; any thread.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "base/result.h"
#include "world/world_def.h"

namespace sim {

class Path {
 public:
  // Of a trajectory plugin, for a model that starts at `start` (world). Elements, all but the way points with a default:
  //   <waypoints><waypoint>x y [z]</waypoint>...</waypoints>  [m, world], or <line><length>: there and back along the model's x axis,
  //   or <circle><radius>: round the start; <loop> (false): from the last way point to the first and on; <speed> (1) [m/s];
  //   <corner_radius> (0) [m]; <turn_rate> (1.57) [rad/s] on the spot; <delay_start> (0) [s].
  // Fails with one line that names the plugin's place, the value and what was expected.
  static base::Result<Path> of(const PluginDef& plugin, const Eigen::Isometry3d& start);

  // Where the model is `seconds` after the start: level, x axis in the direction of motion.
  Eigen::Isometry3d at(double seconds) const;
  double speed() const { return speed_; }
  double turn_rate() const { return turn_rate_; }
  double lap() const { return loop_seconds_; }  // [s] of a round; 0 when there is no loop

 private:
  // A part with constant velocity and yaw rate.
  struct Piece {
    double seconds;
    Eigen::Vector3d from;
    double heading;      // [rad] at its start
    double speed;        // [m/s] in the plane
    double climb, turn;  // [m/s], [rad/s]
  };
  struct Corner {
    Eigen::Vector3d in, out;  // where the curve begins and ends
    double radius, angle;     // angle > 0: to the left
  };

  Path() = default;
  static Eigen::Isometry3d inside(const Piece& piece, double seconds);
  void turn(std::vector<Piece>& to, const Eigen::Vector3d& at, double& heading, double angle) const;
  void line(std::vector<Piece>& to, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double& heading) const;
  void corner(std::vector<Piece>& to, const Corner& corner, double& heading) const;
  Corner round(const Eigen::Vector3d& before, const Eigen::Vector3d& at, const Eigen::Vector3d& after, double radius) const;
  void follow(const std::vector<Eigen::Vector3d>& points, bool is_loop, double corner_radius);

  Eigen::Isometry3d start_ = Eigen::Isometry3d::Identity();
  double speed_ = 1, turn_rate_ = 1.57, delay_ = 0;
  std::vector<Piece> lead_, loop_;  // once, then again and again
  double lead_seconds_ = 0, loop_seconds_ = 0;
};

}  // namespace sim
