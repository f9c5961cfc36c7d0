// The pose of an actor and of its limbs at a time. A value after construction; any thread.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "world/world_def.h"

namespace sim {

struct ActorMoment {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  std::optional<std::size_t> animation;  // that plays: index into ActorDef::animations
  double seconds = 0;                    // since it began to play
  double distance = 0;                   // walked since the script began [m]
};

class ActorMotion {
 public:
  explicit ActorMotion(const ActorDef& actor);

  // `seconds` after the start of the simulation.
  ActorMoment at(double seconds) const;

 private:
  static constexpr std::size_t pieces = 8;  // of a segment, to measure its length
  struct Point {
    WaypointDef place;
    std::size_t trajectory = 0;
    double begin = 0;                         // of its trajectory, on the clock of the script [s]
    std::array<double, pieces + 1> walked{};  // from the first point to each piece of the segment that ends here [m]
  };
  Eigen::Vector3d on_segment(std::size_t end, double share) const;
  std::optional<std::size_t> animation_of(std::size_t trajectory) const;

  const ActorDef actor_;
  std::vector<Point> points_;
  bool is_closed_ = false;
};

}  // namespace sim
