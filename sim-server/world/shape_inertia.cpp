#include "world/shape_inertia.h"

#include <Eigen/Geometry>
#include <cmath>

namespace sim {

namespace {

struct Part {
  Eigen::Isometry3d pose;  // of its middle, in the link
  SolidProperties solid;
};

std::optional<Part> box_around(const CollisionDef& shape, TriangleCache& cache) {
  const auto mesh = cache.triangles(shape.geometry);
  if (!mesh) return std::nullopt;
  Eigen::AlignedBox3d box;
  for (const auto& triangle : (*mesh)->triangles) {
    for (const std::uint32_t corner : triangle) box.extend((*mesh)->vertices[corner]);
  }
  if (box.isEmpty()) return std::nullopt;
  // A sheet has a weight, too.
  const Eigen::Vector3d size = box.sizes().cwiseMax(1e-3 * box.sizes().maxCoeff());
  const auto solid = solid_properties(BoxShape{size});
  if (!solid) return std::nullopt;
  return Part{shape.pose * Eigen::Translation3d(box.center()), *solid};
}

std::optional<Part> part_of(const CollisionDef& shape, TriangleCache& cache) {
  if (const auto solid = solid_properties(shape.geometry)) return Part{shape.pose, *solid};
  const bool has_no_end = std::holds_alternative<PlaneShape>(shape.geometry) || std::holds_alternative<HeightmapShape>(shape.geometry);
  return has_no_end ? std::nullopt : box_around(shape, cache);
}

}  // namespace

std::optional<Eigen::Matrix3d> inertia_of_shapes(const std::vector<CollisionDef>& shapes, double mass, TriangleCache& cache) {
  std::vector<Part> parts;
  double volume = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const CollisionDef& shape : shapes) {
    const std::optional<Part> part = part_of(shape, cache);
    if (!part || !(part->solid.volume > 0)) continue;
    volume += part->solid.volume;
    moment += part->solid.volume * part->pose.translation();
    parts.push_back(*part);
  }
  if (parts.empty()) return std::nullopt;
  const Eigen::Vector3d middle = moment / volume;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (const Part& part : parts) {
    const Eigen::Vector3d arm = part.pose.translation() - middle;
    inertia += part.pose.linear() * part.solid.moments.asDiagonal() * part.pose.linear().transpose();
    inertia += part.solid.volume * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  }
  inertia *= mass / volume;
  constexpr double largest = 1e15;  // what is written must be below, too
  if (!inertia.allFinite() || inertia.cwiseAbs().maxCoeff() > largest) return std::nullopt;
  return inertia;
}

}  // namespace sim
