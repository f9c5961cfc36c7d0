// One model as it lives in an ODE world: its bodies, joints and collision shapes. Private to physics/. One thread at a time.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "physics/blueprint.h"
#include "physics/ode.h"
#include "physics/physics.h"
#include "world/triangles.h"

namespace sim {

// ODE's form of meshes and height maps, shared by all shapes made from them.
class ShapeStore {
 public:
  explicit ShapeStore(TriangleCache& triangles) : triangles_(triangles) {}
  struct Mesh {
    ode::TriMeshData data;
    std::vector<double> vertices;
    std::vector<dTriIndex> indexes;
  };
  struct Field {
    ode::HeightfieldData data;
    std::shared_ptr<const HeightGrid> grid;
  };
  base::Result<std::shared_ptr<Mesh>> mesh(const GeometryDef& geometry);
  base::Result<std::shared_ptr<Field>> field(const HeightmapShape& shape);

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

struct ShapeInstance {
  ode::Geom geom;
  LinkId link;
  std::uint32_t collision = 0;
  std::uint32_t assembly = 0;
  const SurfaceDef* surface = nullptr;
  bool needs_lock = false;  // ODE collides it through global buffers
  Aabb box;
  std::shared_ptr<void> data;
};

struct JointInstance {
  ode::Joint joint;
  std::uint32_t index = 0;  // in ModelDef::joints
  const JointDef* def = nullptr;
  int parent = -1, child = -1;  // assemblies, -1: the world
  double sign = 1;              // of ODE's velocities against SDF's
  struct Drive {
    double velocity = 0, effort = 0;
    bool is_set = false;
    double explicit_damping = 0;
  };
  Drive drives[2];
};

struct BodyState {
  Eigen::Vector3d position, linear, angular;
  Eigen::Quaterniond orientation;
  bool is_awake = true;
};

class ModelInstance {
 public:
  // Anchored assemblies have shapes, but no body. `base` is where the model stands at the start.
  ModelInstance(ModelId id, std::shared_ptr<const Blueprint> blueprint, const Eigen::Isometry3d& base, ShapeStore& shapes,
                std::vector<std::string>& notes);

  // Makes bodies and joints in a world (of the model at its base pose); those it had are gone.
  void enter(dWorldID world, const PhysicsDef& physics);
  // Moves what never moves, too. Only between enter() calls or for models without joints to the world.
  void set_base(const Eigen::Isometry3d& base);

  std::vector<BodyState> save() const;
  void restore(const std::vector<BodyState>& states);

  ModelId id() const { return id_; }
  const Blueprint& blueprint() const { return *blueprint_; }
  const std::shared_ptr<const Blueprint>& shared_blueprint() const { return blueprint_; }
  const Eigen::Isometry3d& base() const { return base_; }
  bool is_awake() const;
  void wake();

  Eigen::Isometry3d assembly_pose(std::uint32_t assembly) const;
  dBodyID body(std::uint32_t assembly) const { return bodies_[assembly].id(); }
  std::size_t body_count() const { return bodies_.size(); }
  std::vector<ShapeInstance>& shapes() { return shapes_; }
  std::vector<JointInstance>& joints() { return joints_; }
  const std::vector<JointInstance>& joints() const { return joints_; }
  JointInstance* joint(std::uint32_t index);

  // Springs and the damping that ODE's motors cannot do; before each step.
  void apply_springs(double dt);
  // Boxes of the moving shapes where they are now; the union.
  const Aabb& update_boxes();
  const Aabb& moving_box() const { return moving_box_; }
  void set_gravity(bool on);
  bool make_kinematic();
  void set_drive(JointInstance& joint, int axis, double velocity, double effort);
  // False when a number has become infinite or a body is faster than anything should be.
  bool is_sane() const;

  // Owned by the world around it.
  int shard = -1;
  Aabb neighbourhood;
  bool left_neighbourhood = true;
  std::vector<std::uint32_t> near_statics;
  std::vector<Contact> contacts, previous_contacts;
  std::uint64_t contacts_so_far = 0;
  bool records_forces = false;

 private:
  void make_shapes(ShapeStore& shapes, std::vector<std::string>& notes);
  base::Result<ShapeInstance> make_shape(const CollisionDef& collision, ShapeStore& shapes);
  void place_anchored();
  void make_joint(dWorldID world, const PhysicsDef& physics, JointInstance& joint);
  void set_axis(dJointID joint, JointInstance& instance, int axis, double dt);
  int assembly_of(const std::string& link) const;

  ModelId id_;
  std::shared_ptr<const Blueprint> blueprint_;
  Eigen::Isometry3d base_;
  std::vector<ode::Body> bodies_;  // one per assembly; empty handles for anchored ones
  std::vector<JointInstance> joints_;
  std::vector<ShapeInstance> shapes_;
  std::vector<Eigen::Isometry3d> shape_in_body_;
  bool has_springs_ = false;
  bool gravity_ = true, is_kinematic_ = false;
  Aabb moving_box_;
};

// Parameter `base_parameter` (dParamVel, ...) of an axis of any joint that has it.
void set_joint_parameter(dJointID joint, int axis, int base_parameter, double value);
double joint_rate(dJointID joint, int axis);
double joint_position(dJointID joint, int axis);
void add_joint_effort(dJointID joint, int axis, double effort);

}  // namespace sim
