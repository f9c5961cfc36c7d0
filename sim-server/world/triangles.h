// Triangles and height grids of the shapes that are no primitives: meshes (Assimp), height maps (PNG), polylines and ellipsoids. What
// physics and rays are built from. The cache is for one thread at a time; what it hands out never changes and any thread may read it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "world/world_def.h"

namespace sim {

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;                // [m], in the shape's frame
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise seen from outside
};

// A regular grid of heights. Row 0 lies at +y, column 0 at -x; the middle of the grid is the origin of x and y.
struct HeightGrid {
  int columns = 0, rows = 0;
  double width = 0, depth = 0;  // along x and y [m]
  std::vector<float> heights;   // [m], row by row
};

class TriangleCache {
 public:
  // Mesh, polyline, ellipsoid and height map; fails for the others, for files that cannot be read and for meshes without a triangle.
  base::Result<std::shared_ptr<const TriangleMesh>> triangles(const GeometryDef& geometry);
  base::Result<std::shared_ptr<const HeightGrid>> heights(const HeightmapShape& shape);

 private:
  std::map<std::string, std::shared_ptr<const TriangleMesh>> meshes_;
  std::map<std::string, std::shared_ptr<const HeightGrid>> grids_;
};

// A pyramid with so many sides.
TriangleMesh cone_triangles(const ConeShape& shape, int segments = 32);
// Ellipsoids are approximated by this many rings and segments.
TriangleMesh ellipsoid_triangles(const Eigen::Vector3d& radii, int rings = 16, int segments = 32);

}  // namespace sim
