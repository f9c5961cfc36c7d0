// The moving world: bodies, joints and contacts of a WorldDef, stepped by ODE. No type of ODE is visible here.
//
// Models that cannot touch each other within a step are stepped separately, on several cores if available: every moving model belongs to
// a shard (one ODE world). Models whose neighbourhoods overlap share a shard, and are separated when they no longer overlap. Shards depend
// on the world alone, never on the number of threads, so the result does not either. One thread at a time (the stepping thread). Units: m,
// rad, kg, N, s; world frame unless a comment says otherwise.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "physics/hash.h"
#include "physics/worker_pool.h"
#include "world/triangles.h"
#include "world/world_def.h"

namespace sim {

// Index of a model; those of deleted models are not used again before a reset.
using ModelId = std::uint32_t;

struct LinkId {
  ModelId model = 0;
  std::uint32_t link = 0;  // index into ModelDef::links
  bool operator==(const LinkId&) const = default;
};
struct JointId {
  ModelId model = 0;
  std::uint32_t joint = 0;  // index into ModelDef::joints
};

struct Twist {
  Eigen::Vector3d linear{0, 0, 0};
  Eigen::Vector3d angular{0, 0, 0};
};

struct JointState {
  double position = 0;  // [m], or [rad]: with whole turns of axes with limits or a spring and of screws, else within (-pi, pi]
  double velocity = 0;  // [rad/s] or [m/s]
};

// A controlled motor in the next step: a row of the solver that asks for the velocity and gives way by `give` for each unit of effort, with
// at most the effort `most`; and an effort `push` beside it.
struct JointRow {
  double velocity = 0, give = 1e-10, most = 0, push = 0;
  bool keeps_awake = false;  // the model does not fall asleep in this step
};

// A belt that runs round a link: what it touches is moved along with its surface. In the world.
struct Belt {
  Eigen::Vector3d axis{0, 1, 0};          // about which it turns: below it the link goes forward, along axis x (up)
  double speed = 0;                       // of its surface [m/s]; forward is positive
  std::optional<Eigen::Vector3d> center;  // of the curve that a vehicle drives: friction then acts along the circle about it
  bool is_free = false;                   // no motor: it gives way along its direction
};

// On a body, with the torque about a place in the world.
struct Wrench {
  Eigen::Vector3d force{0, 0, 0}, torque{0, 0, 0};
  Eigen::Vector3d place{0, 0, 0};
};

struct Contact {
  LinkId link, other;
  std::uint32_t collision = 0, other_collision = 0;  // indexes into LinkDef::collisions
  Eigen::Vector3d position, normal;                  // the normal points to `link`
  Eigen::Vector3d force{0, 0, 0};                    // on `link`; only while forces are recorded for the model
  double depth = 0;
};

struct PhysicsStatistics {
  std::uint32_t bodies = 0, awake = 0, joints = 0, contacts = 0, shards = 0, moves_between_shards = 0;
  std::uint32_t rolling = 0;  // models in the rolling step, also those that sleep
};

// Which solver made a model's last step: ODE's exact one, that along the tree of joints, or ODE's iterative one.
enum class StepSolver : std::uint8_t { dense, tree, iterative };

class Physics {
 public:
  // What could not be built as written is added to `notes`, one line each; models and shapes that cannot be simulated at all are left out,
  // in `dropped`. The pool is used by step() and must outlive the object.
  Physics(std::shared_ptr<const WorldDef> world, WorkerPool& pool, TriangleCache& triangles, std::vector<std::string>& notes,
          std::vector<std::string>& dropped);
  ~Physics();
  Physics(const Physics&) = delete;
  Physics& operator=(const Physics&) = delete;

  // Whether robots that roll alone on level ground are moved by the rolling step (rolling.h) from now on; not at the start.
  void let_roll(bool on);

  // One step of WorldDef::physics.step.
  void step();
  // As after construction, to the bit; models spawned are gone, models deleted are back.
  void reset();
  // All models where they were at the start, at rest; what was spawned stays.
  void reset_poses();

  double step_length() const;
  Eigen::Vector3d wind() const;  // in the next step [m/s]
  std::uint64_t steps() const;   // since the start or the last reset

  std::size_t model_slots() const;  // ids are below this
  bool exists(ModelId model) const;
  std::optional<ModelId> find(std::string_view name) const;
  const ModelDef& def(ModelId model) const;
  std::shared_ptr<const ModelDef> shared_def(ModelId model) const;
  // "model" or "model::link" (nested: "model::arm::hand"); a model's name stands for its canonical link.
  std::optional<LinkId> find_link(std::string_view name) const;
  std::optional<JointId> find_joint(std::string_view name) const;  // "model::joint"
  LinkId canonical_link(ModelId model) const;

  // Name must be new; fails with a line when the model cannot be simulated.
  base::Result<ModelId> spawn(std::shared_ptr<const ModelDef> model, std::vector<std::string>& notes);
  void remove(ModelId model);

  bool is_static(ModelId model) const;  // nothing of it can move
  bool can_move(LinkId link) const;
  Eigen::Isometry3d model_pose(ModelId model) const;  // follows the canonical link
  Eigen::Isometry3d link_pose(LinkId link) const;
  // The box around the model's collision shapes at their current poses, along the axes of its frame; empty without a shape. A plane is
  // bounded only along its normal, and only if the normal is along an axis.
  Eigen::AlignedBox3d shape_box(ModelId model) const;
  // Of the link's origin.
  Twist link_twist(LinkId link) const;
  // Of the link's origin when `point` is given in the world, moving with the link.
  Eigen::Vector3d point_velocity(LinkId link, const Eigen::Vector3d& point) const;
  Eigen::Vector3d center_of_mass(LinkId link) const;  // of the body that the link belongs to

  // The whole model, joints kept as they are, at rest. Fails for poses that are not finite.
  base::Result<void> set_model_pose(ModelId model, const Eigen::Isometry3d& pose);
  // The whole model moves as one rigid body: `linear` is that of its canonical link's origin.
  base::Result<void> set_model_twist(ModelId model, const Twist& twist);
  // For the next step only, at the centre of mass of the link's body.
  base::Result<void> add_wrench(LinkId link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque);
  // For the next step only, about or along the first axis of the joint, beside what its motor does: [N m] or [N], on the child against the
  // parent. Fails as check_effort() does: for a joint that neither turns nor slides, and for efforts of 1e7 and more.
  base::Result<void> add_effort(JointId joint, double effort);
  base::Result<void> check_effort(JointId joint, double effort) const;
  void set_gravity(ModelId model, bool on);
  // Moves as it is told from now on, whatever it touches. For models without joints that move; false for others.
  bool make_kinematic(ModelId model);

  JointState joint_state(JointId joint, int axis = 0) const;
  // The motor of the joint turns it with `velocity`, within the joint's own limit, and at most `effort` [N m or N] until it is set again.
  // Effort 0: runs free.
  void set_motor(JointId joint, int axis, double velocity, double effort);
  // The same of a joint with one axis that has a controller; it is set before each step. From then on set_motor leaves the joint alone, and
  // the model is stepped along its tree of joints, where that is one.
  void set_row(JointId joint, const JointRow& row);

  // Holds two links of different models together as they are now, until they are detached, one of the models is removed or put elsewhere,
  // or the world is reset. Links that are held together do not collide. Fails when neither can move, or they are held together already.
  base::Result<void> attach(LinkId first, LinkId second);
  void detach(LinkId first, LinkId second);
  bool are_attached(LinkId first, LinkId second) const;
  // Of a link, until it is set again. The link and what lies on it stay awake while it runs.
  void set_belt(LinkId link, const Belt& belt);

  // What the joint put on its child link in the last step, about the child body's centre of mass. Measured for joints with sensors or
  // <provide_feedback>; empty for others and for joints that are no more than a weld.
  std::optional<Wrench> joint_load(JointId joint) const;

  // Contacts of the last step in which the model was awake.
  std::span<const Contact> contacts(ModelId model) const;
  std::uint64_t contacts_so_far(ModelId model) const;
  // From now on with their forces.
  void record_forces(ModelId model);

  // Everything that decides how the run goes on.
  void add_to(StateHash& hash) const;
  // The same of one model.
  void add_to(StateHash& hash, ModelId model) const;
  // As much, quicker: where it was put instead of its pose, which follows from that and its parts. For comparing a model with itself.
  void add_place_and_parts_to(StateHash& hash, ModelId model) const;
  PhysicsStatistics statistics() const;
  StepSolver last_solver(ModelId model) const;
  // One line for each model that had to be put back because it left the numbers, since the last call.
  std::vector<std::string> take_complaints();

  // For rays: the rigid pieces that models consist of. A piece is all links of a model that cannot move against each other.
  std::uint32_t piece_count(ModelId model) const;
  std::uint32_t piece_of(LinkId link) const;
  bool piece_can_move(ModelId model, std::uint32_t piece) const;
  Eigen::Isometry3d piece_pose(ModelId model, std::uint32_t piece) const;
  std::vector<std::uint32_t> piece_links(ModelId model, std::uint32_t piece) const;
  Eigen::Isometry3d link_in_piece(LinkId link) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sim
