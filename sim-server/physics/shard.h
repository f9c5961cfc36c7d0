// One ODE world with its models: finds their contacts and steps them. Private to physics/. Different shards may be stepped by different
// threads at the same time; they share static shapes, which no thread changes meanwhile.
//
// Moving models are found near each other by boxes of their own instead of ODE's quad-tree space, and models that can meet share a shard.
// Each group of models that touch is solved exactly, or by ODE's quick step if many moving bodies lie on each other. The exact solver is
// ODE's, or TreeSolver if one of the models has many joints. Sleeping models cost nothing.
#pragma once

#include <deque>
#include <vector>

#include "physics/contact_groups.h"
#include "physics/free_rotation.h"
#include "physics/impacts.h"
#include "physics/model_instance.h"
#include "physics/ode.h"
#include "physics/tree_solver.h"

namespace sim {

class Shard {
 public:
  Shard(const PhysicsDef& physics, const Air& air);
  Shard(const Shard&) = delete;
  Shard& operator=(const Shard&) = delete;

  dWorldID world() const { return world_.id(); }
  void step(const std::vector<ShapeInstance*>& statics, std::uint64_t step_count);

  std::vector<ModelInstance*> models;  // ascending by id
  bool has_left = false;               // some model left its neighbourhood in the last step
  bool is_insane = false;              // some model has to be put back
  std::uint32_t contacts = 0;

 private:
  void roll(const std::vector<ShapeInstance*>& statics);
  void note_place(ModelInstance& model);
  void find_active();
  void find_turning();
  void tie_welded();
  void find_contacts(const std::vector<ShapeInstance*>& statics);
  void solve(std::uint64_t step_count);
  void solve_trees();
  bool solve_tree(const std::vector<ModelInstance*>& group);
  void solve_exactly();
  void solve_iteratively(std::uint64_t step_count);
  void finish(const std::vector<ShapeInstance*>& statics);
  void collide_model(ModelInstance& model, const std::vector<ShapeInstance*>& statics);
  void collide_pair(ModelInstance& a, ModelInstance& b);
  // `a` has a body.
  void collide(ModelInstance& model_a, ShapeInstance& a, ModelInstance* model_b, ShapeInstance& b);
  void add_contact(ModelInstance& model_a, ShapeInstance& a, ModelInstance* model_b, ShapeInstance& b, const dContactGeom& geometry,
                   const dSurfaceParameters& surface, bool has_force);
  void read_forces();

  struct Feedback {
    dJointFeedback joint{};
    ModelInstance *a = nullptr, *b = nullptr;
    std::size_t contact_a = 0, contact_b = 0;
  };
  const PhysicsDef& physics_;
  const Air& air_;
  const double gravity_, erp_;  // [m/s^2]; the world's error reduction
  ode::World world_;
  ode::JointGroup contact_joints_;
  std::deque<Feedback> feedback_;
  ContactGroups groups_;
  TreeSolver tree_solver_;
  FreeRotation free_rotation_;
  Impacts impacts_;
  std::vector<ModelInstance*> rolling_;     // models in the rolling step, during it
  bool has_many_joints_ = false;            // one of the active models
  bool has_muddle_ = false;                 // in this step some that are too deep in each other do not count
  std::vector<MadeContact> made_contacts_;  // of the step, while it has
  std::vector<dBodyID> lying_;              // those of the other solver
  std::vector<ModelInstance*> active_;      // models that take part in a step, during it, ascending by id
};

}  // namespace sim
