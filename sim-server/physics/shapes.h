// Collision shapes in ODE's form. Private to physics/. One thread at a time.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "physics/ode.h"
#include "physics/physics.h"
#include "world/triangles.h"

namespace sim {

class Solid;

// ODE's form of meshes and height maps, shared by all shapes made from them.
class ShapeStore {
 public:
  explicit ShapeStore(TriangleCache& triangles) : triangles_(triangles) {}
  struct Mesh {
    ode::TriMeshData data;
    std::vector<double> vertices;
    std::vector<dTriIndex> indexes;
    std::shared_ptr<const TriangleMesh> triangles;
    std::shared_ptr<const Solid> solid;  // once it has met another mesh
  };
  struct Field {
    ode::HeightfieldData data;
    std::shared_ptr<const HeightGrid> grid;
  };
  base::Result<std::shared_ptr<Mesh>> mesh(const GeometryDef& geometry);
  base::Result<std::shared_ptr<Field>> field(const HeightmapShape& shape);
  TriangleCache& triangles() { return triangles_; }

 private:
  TriangleCache& triangles_;
  std::map<const TriangleMesh*, std::shared_ptr<Mesh>> meshes_;
  std::map<const HeightGrid*, std::shared_ptr<Field>> fields_;
};

struct Aabb {
  Eigen::Vector3d low{infinite, infinite, infinite}, high{-infinite, -infinite, -infinite};
  void extend(const Aabb& o) { low = low.cwiseMin(o.low), high = high.cwiseMax(o.high); }
  bool overlaps(const Aabb& o) const { return (low.array() <= o.high.array()).all() && (o.low.array() <= high.array()).all(); }
  bool contains(const Aabb& o) const { return (low.array() <= o.low.array()).all() && (o.high.array() <= high.array()).all(); }
  bool is_empty() const { return low.x() > high.x(); }
};
Aabb box_of(dGeomID geom);

// Where the first friction axis of a shape comes from, when it is not its own frame.
struct FrictionFrame {
  std::uint32_t assembly = 0;  // of the model, that the direction turns with
  dBodyID body = nullptr;      // of that; null: it never moves
  Eigen::Vector3d direction;   // in the body
  Eigen::Vector3d in_world;    // where it never moves
};

// How a wheel slips, by its speed.
struct WheelSlip {
  int carrier = -1;  // the assembly of the model that its joint hangs on; -1: the world
  dBodyID wheel = nullptr, carrier_body = nullptr;
  Eigen::Vector3d axle{0, 1, 0};         // in the wheel's body
  double lateral = 0, longitudinal = 0;  // [m/s per N] for each rad/s
  bool is_rolling_first = false;         // the surface's own first direction is the one in which it rolls
};

struct ShapeInstance {
  ode::Geom geom;
  LinkId link;
  std::uint32_t collision = 0;
  std::uint32_t assembly = 0;
  const SurfaceDef* surface = nullptr;
  bool needs_lock = false;  // ODE collides it through global buffers
  bool is_wheel = false;    // a cylinder that turns about its own axis in a joint
  Aabb box;
  std::uint32_t partners = 0, deep_partners = 0;  // moving shapes that it touches in this step, and those that it is much too deep in
  std::shared_ptr<void> data;
  std::unique_ptr<FrictionFrame> friction_frame;  // of few
  std::unique_ptr<WheelSlip> slip;
  std::unique_ptr<Belt> belt;
};

// Around the shape when it is at `place`, along the axes.
Eigen::AlignedBox3d box_of(const ShapeInstance& shape, const GeometryDef& geometry, const Eigen::Isometry3d& place);

// The shape without a place and an owner. Fails when a file cannot be read.
base::Result<ShapeInstance> make_shape(const CollisionDef& collision, ShapeStore& store);
// Pose of the ODE geom in the frame of the collision.
Eigen::Isometry3d geom_in_collision(const GeometryDef& geometry);

}  // namespace sim
