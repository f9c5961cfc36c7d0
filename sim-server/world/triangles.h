// Triangles and height grids of the shapes that are no primitives: meshes and height maps, whose files a process of its own reads
// (reader/asset_reader.h), polylines and ellipsoids. Physics and rays are built from them. The cache is for one thread at a time; what it
// hands out never changes and any thread may read it. A file is read once for all caches of this process, and again when it has changed;
// one cache keeps what it has once handed out for a shape.
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

  // Reads the files of all collisions of a model that is to be spawned, and sets the versions of their meshes. What cannot be read is kept
  // as such: the cache that adopts this one reads nothing for this model.
  void prepare(ModelDef& model);
  void adopt(TriangleCache&& other);

 private:
  std::map<std::string, std::shared_ptr<const TriangleMesh>> meshes_;
  std::map<std::string, std::shared_ptr<const HeightGrid>> grids_;
  std::map<std::string, base::Error> faults_;  // of models that were prepared
};

// A pyramid with so many sides.
TriangleMesh cone_triangles(const ConeShape& shape, int segments = 32);
// Ellipsoids are approximated by this many rings and segments.
TriangleMesh ellipsoid_triangles(const Eigen::Vector3d& radii, int rings = 16, int segments = 32);

}  // namespace sim
