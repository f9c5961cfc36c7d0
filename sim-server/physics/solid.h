// Queries on a triangle mesh: whether a point is inside, the nearest point of its surface, and intersections with a line. Private to
// physics/. Read only after construction; any thread.
//
// Inside and outside are determined by the normals of faces, edges and corners (each the mean of its faces, weighted by angles). This is
// right everywhere for a closed surface, and near the surface for an open one. A closed surface that is turned inside out is turned back.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "physics/shapes.h"
#include "world/triangles.h"

namespace sim {

class Solid {
 public:
  explicit Solid(const TriangleMesh& mesh);

  struct Corner {
    Eigen::Vector3d place, outward;
  };
  struct Edge {
    std::uint32_t a = 0, b = 0;  // corners
    Eigen::Vector3d outward;
    bool is_sharp = false;  // sticks out; flat and inner ones touch nothing first
  };
  struct Face {
    std::array<std::uint32_t, 3> corners{}, edges{};
    Eigen::Vector3d normal;
  };
  const std::vector<Corner>& corners() const { return corners_; }
  const std::vector<Edge>& edges() const { return edges_; }
  const std::vector<Face>& faces() const { return faces_; }
  bool is_closed() const { return is_closed_; }

  static constexpr double open_depth = 0.05;  // [m] behind a surface that is not closed is inside of it
  // False for what is certainly outside.
  bool may_contain(const Eigen::Vector3d& point) const {
    const double around = is_closed_ ? 0 : open_depth;
    const Aabb& box = nodes_.front().box;
    return (point.array() >= box.low.array() - around).all() && (point.array() <= box.high.array() + around).all();
  }

  struct Nearest {
    Eigen::Vector3d place, normal;  // on the surface; the normal points out
    double distance = 0;            // [m]
    bool is_inside = false;         // of the point that was asked about
  };
  // The nearest place of the surface within `reach`; with `against` only of faces that look the other way.
  std::optional<Nearest> nearest(const Eigen::Vector3d& point, double reach, const Eigen::Vector3d* against = nullptr) const;

  struct Crossing {
    double at = 0;  // 0..1 between the ends
    std::uint32_t face = 0;
  };
  // Ascending; each place once.
  void crossings(const Eigen::Vector3d& from, const Eigen::Vector3d& to, std::vector<Crossing>& found) const;

  // Adds the faces whose boxes meet `box`.
  void faces_in(const Aabb& box, std::vector<std::uint32_t>& faces) const;

 private:
  struct Node {
    Aabb box;
    std::uint32_t first = 0, count = 0;  // faces in order_; count 0: the children are at first and first + 1
  };
  void weld(const TriangleMesh& mesh);
  void find_edges();
  void find_normals();
  void split(std::uint32_t node, std::uint32_t first, std::uint32_t count);
  Aabb box_of_face(std::uint32_t face) const;
  Nearest nearest_on(std::uint32_t face, const Eigen::Vector3d& point) const;

  std::vector<Corner> corners_;
  std::vector<Edge> edges_;
  std::vector<Face> faces_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  bool is_closed_ = false;
};

}  // namespace sim
