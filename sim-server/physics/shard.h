// One ODE world with the models that live in it: finds their contacts and steps them. Private to physics/. Different shards may be
// stepped by different threads at the same time; they share static shapes, which nobody changes meanwhile.
//
// Moving models are found near each other by boxes of their own instead of ODE's quad-tree space, and models that can meet share a shard.
// When many moving bodies touch, a shard takes ODE's quick step for the step.
#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "physics/model_instance.h"
#include "physics/ode.h"

namespace sim {

class Shard {
 public:
  explicit Shard(const PhysicsDef& physics);
  Shard(const Shard&) = delete;
  Shard& operator=(const Shard&) = delete;

  dWorldID world() const { return world_.id(); }
  void step(const std::vector<ShapeInstance*>& statics, std::uint64_t step_count);

  // Ascending by id. Pairs are those whose neighbourhoods overlap.
  std::vector<ModelInstance*> models;
  std::vector<std::pair<ModelInstance*, ModelInstance*>> pairs;
  bool has_left = false;   // some model left its neighbourhood in the last step
  bool is_insane = false;  // some model has to be put back
  std::uint32_t contacts = 0;

 private:
  void find_active();
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
  const double gravity_, erp_;  // [m/s^2]; the world's error reduction
  ode::World world_;
  ode::JointGroup contact_joints_;
  std::deque<Feedback> feedback_;
  std::vector<bool> active_;
  std::uint32_t moving_contacts_ = 0;  // between two bodies that can move
};

}  // namespace sim
