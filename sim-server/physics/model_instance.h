// One model as it lives in an ODE world: its bodies, joints and collision shapes. Private to physics/. One thread at a time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "physics/blueprint.h"
#include "physics/joints.h"
#include "physics/ode.h"
#include "physics/physics.h"
#include "physics/shapes.h"

namespace sim {

struct BodyState {
  Eigen::Vector3d position, linear, angular;
  Eigen::Quaterniond orientation;
  bool is_awake = true;
};

class ModelInstance {
 public:
  // Anchored assemblies have shapes, but no body. `base` is where the model stands at the start.
  // Shapes that are missing, because a file cannot be read or they cannot move, add a line to `lost`.
  ModelInstance(ModelId id, std::shared_ptr<const Blueprint> blueprint, const Eigen::Isometry3d& base, ShapeStore& shapes,
                std::vector<std::string>& lost);

  // Makes bodies and joints in a world (of the model at its base pose); those it had are gone.
  void enter(dWorldID world, const PhysicsDef& physics);
  // After enter(): those of a saved state.
  void take_initial_velocities();
  // Moves what never moves, too. Only between enter() calls or for models without joints to the world.
  void set_base(const Eigen::Isometry3d& base);

  std::vector<BodyState> save() const;
  void restore(const std::vector<BodyState>& states);

  ModelId id() const { return id_; }
  const Blueprint& blueprint() const { return *blueprint_; }
  const Eigen::Isometry3d& base() const { return base_; }
  double mass() const { return mass_; }  // of all that can move
  bool is_awake() const;
  void wake();

  Eigen::Isometry3d assembly_pose(std::uint32_t assembly) const;
  dBodyID body(std::uint32_t assembly) const { return bodies_[assembly].id(); }
  std::size_t body_count() const { return bodies_.size(); }
  std::vector<ShapeInstance>& shapes() { return shapes_; }
  std::vector<JointInstance>& joints() { return joints_; }
  const std::vector<JointInstance>& joints() const { return joints_; }
  JointInstance* joint(std::uint32_t index);

  // Springs, couplings and wind; before each step. Joints that hold for this step alone go into the group.
  void apply_forces(dJointGroupID step_joints, const PhysicsDef& physics);
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
  std::optional<std::uint64_t> put_back_at;  // the step in which it last left the numbers

 private:
  void make_shapes(ShapeStore& shapes, std::vector<std::string>& lost);
  void place_anchored();
  void make_body(dWorldID world, const Assembly& assembly);
  void make_joint(dWorldID world, const PhysicsDef& physics, std::uint32_t index);
  void take_initial_positions();
  void float_in(const FluidDef& fluid, const Eigen::Vector3d& gravity);
  int assembly_of(const std::string& link) const;

  ModelId id_;
  std::shared_ptr<const Blueprint> blueprint_;
  Eigen::Isometry3d base_;
  std::vector<ode::Body> bodies_;  // one per assembly; empty handles for anchored ones
  std::vector<JointInstance> joints_;
  std::vector<ShapeInstance> shapes_;
  std::vector<Eigen::Isometry3d> shape_in_body_;
  std::vector<double> shape_volumes_;  // [m^3]; 0: not known
  double mass_ = 0;
  bool has_forces_ = false;
  bool gravity_ = true, is_kinematic_ = false;
  Aabb moving_box_;
};

}  // namespace sim
