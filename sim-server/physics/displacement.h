// The part of a shape below a plane, its volume and its middle, which a fluid lifts. Private to physics/. Read only after construction; any
// thread.
//
// Spheres and ellipsoids are exact, and so are boxes, meshes, cones and polylines, up to the plane through their triangles; cylinders and
// capsules are prisms of their own volume. A mesh that is open above, as a hull is, counts as filled up to the plane.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "world/triangles.h"

namespace sim {

class Displacement {
 public:
  struct Part {
    double volume = 0;                // [m^3]
    Eigen::Vector3d moment{0, 0, 0};  // volume times its middle [m^4], in the shape's frame
  };

  // Empty for shapes without a volume: planes, height maps, and meshes that cannot be read.
  static std::optional<Displacement> of(const GeometryDef& geometry, TriangleCache& triangles);

  const Part& whole() const { return whole_; }
  // Of the points p with normal . p < height; the normal is a unit vector, in the shape's frame.
  Part below(const Eigen::Vector3d& normal, double height) const;

 private:
  // Sums over the faces of a block: of their areas as vectors, and of these times the place and the products of places.
  struct Sums {
    Eigen::Vector3d area = Eigen::Vector3d::Zero();
    Eigen::Matrix3d place = Eigen::Matrix3d::Zero();  // row: component of the place; column: of the area
    std::array<Eigen::Matrix3d, 3> product{Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero(), Eigen::Matrix3d::Zero()};  // by area
  };
  using Triangle = std::array<Eigen::Vector3d, 3>;
  struct Block {
    std::size_t first = 0, end = 0;  // of triangles_
    Eigen::AlignedBox3d box;
    Sums sums;
  };
  struct Integrals {
    double volume = 0, square = 0;  // of the depth below the plane, and of its square, through the faces
    Eigen::Vector3d moment{0, 0, 0};
  };

  static Displacement of_ellipsoid(const Eigen::Vector3d& radii);
  static std::optional<Displacement> of_triangles(const TriangleMesh& mesh);
  void split(std::size_t first, std::size_t end);
  static void add(Integrals& to, const Eigen::Vector3d& normal, double height, const Triangle& face);
  static void add_below(Integrals& to, const Eigen::Vector3d& normal, double height, const Triangle& face);
  static void add_block(Integrals& to, const Eigen::Vector3d& normal, double height, const Sums& sums);

  Eigen::Vector3d radii_{0, 0, 0};  // of an ellipsoid
  std::vector<Triangle> triangles_;
  std::vector<Block> blocks_;
  Eigen::AlignedBox3d box_;
  double side_ = 1;  // -1: the mesh is turned inside out
  Part whole_;
};

}  // namespace sim
