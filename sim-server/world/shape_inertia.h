// The inertia of a body that is known by its mass and its shapes. One thread at a time.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "world/triangles.h"
#include "world/world_def.h"

namespace sim {

// Of a body of one density with these shapes [kg m^2], about its middle, along the link's axes. Meshes, polylines and cones count as the
// boxes around them; planes, height maps and meshes that cannot be read do not count. Empty when nothing is left to weigh, or when the
// result is not finite.
std::optional<Eigen::Matrix3d> inertia_of_shapes(const std::vector<CollisionDef>& shapes, double mass, TriangleCache& cache);

}  // namespace sim
