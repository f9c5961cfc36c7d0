// The footprint of a model on the ground, seen from above: convex polygons, and the distance between them. Values; any thread.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace campaign {

using Polygon = std::vector<Eigen::Vector2d>;  // convex, counter-clockwise [m]

// The parts of a model, in three dimensions in the model's frame: the corners of each shape that collides.
struct Outline {
  std::vector<std::vector<Eigen::Vector3d>> parts;
};

Polygon hull(std::vector<Eigen::Vector2d> points);
std::vector<Polygon> footprint(const Outline& outline, const Eigen::Isometry3d& pose);
// 0 when they touch or overlap.
double distance(const Polygon& a, const Polygon& b);
double distance(const std::vector<Polygon>& a, const std::vector<Polygon>& b);

inline constexpr std::array pose_parts = {"x", "y", "z", "roll", "pitch", "yaw"};
// "x y z roll pitch yaw" [m, rad]; missing numbers are 0.
Eigen::Isometry3d to_pose(const std::vector<double>& numbers);

}  // namespace campaign
