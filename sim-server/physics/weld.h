// Two bodies of different models that are held together as they were when they were attached, until they are detached. Private to physics/.
// One thread at a time.
//
// The shard creates ODE's joint again when a body was replaced (the model has moved to another shard) or deleted. Where the tree solver
// steps the models, it has rows of its own for the weld and switches the joint off. Contacts between the two bodies do not count.
#pragma once

#include <Eigen/Geometry>

#include "physics/ode.h"
#include "physics/physics.h"

namespace sim {

class ModelInstance;

class Weld {
 public:
  // As they are now. The second one has a body; the first may be held by the world.
  Weld(ModelInstance& first, std::uint32_t first_assembly, ModelInstance& second, std::uint32_t second_assembly);

  bool is_of(const ModelInstance& model) const { return &model == first_ || &model == second_; }
  bool joins(ModelId a, std::uint32_t a_assembly, ModelId b, std::uint32_t b_assembly) const;
  // Which of the two the weld is counted for.
  bool is_counted_for(const ModelInstance& model) const { return &model == second_; }
  ModelInstance& first() const { return *first_; }
  ModelInstance& second() const { return *second_; }
  ModelInstance& other(const ModelInstance& model) const { return &model == first_ ? *second_ : *first_; }
  dBodyID first_body() const;  // null: the world
  dBodyID second_body() const;
  // Where the middle of the second body has to be now.
  Eigen::Isometry3d wanted() const;

  // Before each step: ODE's joint between the two bodies.
  dJointID prepare(dWorldID world);
  void add_to(StateHash& hash) const;

 private:
  ModelInstance *first_, *second_;
  std::uint32_t first_assembly_, second_assembly_;
  Eigen::Isometry3d second_in_first_;
  ode::Joint joint_;
  dWorldID world_ = nullptr;
};

}  // namespace sim
