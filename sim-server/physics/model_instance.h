// One model in an ODE world: its bodies, joints and collision shapes. Private to physics/. One thread at a time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "physics/blueprint.h"
#include "physics/body_forces.h"
#include "physics/joint_tree.h"
#include "physics/joints.h"
#include "physics/ode.h"
#include "physics/physics.h"
#include "physics/rolling.h"
#include "physics/shapes.h"

namespace sim {

class Weld;

struct Energy {
  double motion = 0, height = 0;  // [J]; the height's from the world's origin
  double sum() const { return motion + height; }
};

struct BodyState {
  Eigen::Vector3d position, linear, angular;
  Eigen::Quaterniond orientation;
  bool is_awake = true;
};

class ModelInstance {
 public:
  // Anchored assemblies have shapes, but no body. `base` is where the model stands at the start.
  // Shapes that are missing, because a file cannot be read or they cannot move, add a line to `lost`.
  ModelInstance(ModelId id, std::shared_ptr<const Blueprint> blueprint, const Eigen::Isometry3d& base, const PhysicsDef& physics,
                ShapeStore& shapes, std::vector<std::string>& lost);

  // Makes bodies and joints in a world (of the model at its base pose); those it had are gone.
  void enter(dWorldID world, const PhysicsDef& physics);
  // After enter(): those of a saved state.
  void take_initial_velocities();
  // Moves what never moves, too. Only between enter() calls or for models without joints to the world.
  void set_base(const Eigen::Isometry3d& base);

  struct State {
    std::vector<BodyState> bodies;
    std::vector<JointInstance::Places> joints;
    std::vector<BodyForces::Memory> forces;
  };
  State save() const;
  // Its bodies, without a place for all of them.
  template <class Take>
  void for_each_state(const Take& take) const {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (const auto each = state(i)) take(*each);
    }
  }
  // After enter() of the same model; `dt`: the step.
  void restore(const State& state, double dt);
  // After each step of `dt` that may have moved it: angles beyond half a turn and the stops of joints.
  void follow_joints(double dt);

  ModelId id() const { return id_; }
  const Blueprint& blueprint() const { return *blueprint_; }
  const Eigen::Isometry3d& base() const { return base_; }
  double mass() const { return mass_; }  // of all that can move
  bool is_awake() const;
  void wake();
  void sleep();
  // After each step of `dt` in which it took part: true when it has not moved for long enough to sleep.
  bool lies_still(double dt, bool touches);

  Eigen::Isometry3d assembly_pose(std::uint32_t assembly) const;
  dBodyID body(std::uint32_t assembly) const { return bodies_[assembly].id(); }
  std::size_t body_count() const { return bodies_.size(); }
  std::vector<ShapeInstance>& shapes() { return shapes_; }
  const std::vector<ShapeInstance>& shapes() const { return shapes_; }
  std::vector<JointInstance>& joints() { return joints_; }
  const std::vector<JointInstance>& joints() const { return joints_; }
  JointInstance* joint(std::uint32_t index);
  const JointTree& tree() const { return tree_; }
  std::uint32_t joint_rows() const { return joint_rows_; }  // of the constraints that its joints make in ODE
  std::uint32_t moving_body_count() const { return moving_bodies_; }

  // Springs, couplings, water and air; before each step. Joints that hold for this step alone go into the group.
  void apply_forces(dJointGroupID step_joints, const PhysicsDef& physics, const Air& air);
  // Boxes of the moving shapes where they are now; the union.
  const Aabb& update_boxes();
  const Aabb& moving_box() const { return moving_box_; }
  void set_moving_box(const Aabb& box) { moving_box_ = box; }
  double fastest_body() const;  // [m/s]
  BodyForces& forces() { return forces_; }
  const BodyForces& forces() const { return forces_; }
  void set_gravity(bool on);
  bool make_kinematic();
  void set_drive(JointInstance& joint, int axis, double velocity, double effort);
  void set_row(JointInstance& joint, const JointRow& row);
  void set_belt(std::uint32_t link, const Belt& belt);
  // Joints that follow another one, by indexes into ModelDef::joints.
  struct Mimic {
    std::uint32_t follower = 0, leader = 0;
  };
  const std::vector<Mimic>& mimics() const { return mimics_; }
  // The solver along the tree of joints steps it: it has many, or controllers, whose joints ODE's own solver would throw off their stops.
  bool is_for_tree() const;
  // Of all that can move.
  Energy energy(const Eigen::Vector3d& gravity) const;
  bool has_stand_ins() const;
  // A motor is to turn a joint.
  bool has_moving_drive() const;
  // Motors or its own way of moving may give it energy.
  bool is_driven() const;
  // All its velocities times `factor`.
  void slow_down(double factor);
  // False when a number has become infinite or a body is faster than anything should be.
  bool is_sane() const;

  // Shapes do not follow their bodies until they are hung on them again: nothing looks at those of a model in the rolling step.
  void drop_shapes();
  void hang_shapes();
  // In the rolling step.
  bool rolls() const { return rolling && rolling->is_rolling(); }
  void stop_rolling() {
    if (rolling) rolling->stop(*this);
  }

  // Owned by the world around it.
  std::unique_ptr<Rolling> rolling;  // null: it cannot, or may not
  int shard = -1;
  bool is_active = false;                  // takes part in this step: it is awake, or near what is
  double load_near = 0;                    // [kg] of its group in the last step, if that is uneven
  bool may_be_awake = true;                // false: certainly not
  std::uint32_t group_place = 0;           // among those that take part
  bool is_iterative = false;               // the solver of this step
  bool is_tree_solved = false;             // of those that are exact: by tree_solver
  std::vector<Weld*> welds;                // that hold it
  std::vector<ModelInstance*> neighbours;  // whose neighbourhoods meet its own, ascending by id
  Aabb neighbourhood;
  bool left_neighbourhood = true;
  std::vector<std::uint32_t> near_statics;
  std::vector<Contact> contacts, previous_contacts;
  std::uint64_t contacts_so_far = 0;
  bool lies_on_belt = false;  // of another model, in this step
  bool records_forces = false;
  std::optional<std::uint64_t> put_back_at;  // the step in which it last left the numbers

 private:
  void make_shapes(ShapeStore& shapes, std::vector<std::string>& lost);
  void place_anchored();
  void add_direction(ShapeInstance& shape, const SurfaceDef& surface);
  void add_slip(ShapeInstance& shape);
  void find_bodies_of(ShapeInstance& shape) const;
  void make_body(dWorldID world, const Assembly& assembly);
  void make_joint(dWorldID world, const PhysicsDef& physics, std::uint32_t index);
  void take_initial_positions();
  void begin_joints(double dt);
  int assembly_of(const std::string& link) const;
  // Nothing of an anchored one.
  std::optional<BodyState> state(std::size_t assembly) const;

  ModelId id_;
  std::shared_ptr<const Blueprint> blueprint_;
  Eigen::Isometry3d base_;
  std::vector<ode::Body> bodies_;  // one per assembly; empty handles for anchored ones
  std::vector<JointInstance> joints_;
  JointTree tree_;
  std::uint32_t joint_rows_ = 0, moving_bodies_ = 0;
  std::vector<int> joint_places_;  // in joints_, by index into ModelDef::joints; -1: it has none
  std::vector<ShapeInstance> shapes_;
  std::vector<Eigen::Isometry3d> shape_in_body_;
  double mass_ = 0;
  BodyForces forces_;
  bool has_forces_ = false;
  bool has_followed_ = false;  // joints
  bool has_rows_ = false;      // controllers
  bool has_rotors_ = false;    // joints with rotor inertias
  bool has_running_belt_ = false;
  std::vector<Mimic> mimics_;
  bool gravity_ = true, is_kinematic_ = false;
  std::uint32_t still_steps_ = 0, slow_steps_ = 0;  // since it was faster
  Aabb moving_box_;
};

}  // namespace sim
