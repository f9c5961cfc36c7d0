// Models that touch in a step make a group: the unit that a solver is chosen for, that falls asleep as one, and that gains no energy from
// contacts of meshes. A model that touches nothing that moves is a group of its own. Private to physics/. One thread at a time.
//
// A group in which a mesh is touched, and in which no motor and no spring works, has no more energy after the step than before and what
// forces on its bodies have done; where it would, all its velocities become smaller by one factor, which leaves joints as they are.
#pragma once

#include <cstdint>
#include <vector>

#include "physics/model_instance.h"
#include "physics/ode.h"
#include "physics/solver_choice.h"

namespace sim {

class ContactGroups {
 public:
  explicit ContactGroups(const PhysicsDef& physics) : physics_(physics) {}

  // Every model that takes part in the step, once.
  void add(ModelInstance& model);
  // A contact with a force; `b` is null for what does not move. Both have been added. `depth` [m] is what is to be pushed back.
  void touch(ModelInstance& a, ModelInstance* b, bool has_mesh, double depth, const dSurfaceParameters& surface);

  // A weld between them. Both have been added.
  void tie(ModelInstance& a, ModelInstance& b);

  // An exact solution for the models that touch this one makes no sense (solver_choice.h).
  void note_ill_conditioned(const ModelInstance& model) { members_[root(model.group_place)].size.is_ill_conditioned = true; }

  // A belt moves it: its energy is not limited.
  void note_driven(const ModelInstance& model) { members_[root(model.group_place)].is_exempt = true; }

  // After the contacts: which models go to the iterative solver (ModelInstance::is_iterative), and which are tried with TreeSolver first
  // (is_tree_solved).
  void share_out();
  // The same number for models that touch.
  std::uint32_t group_of(const ModelInstance& model) { return root(model.group_place); }
  std::uint32_t contacts() const { return contacts_; }

  // Between them the world makes its step. Forces of the step are on the bodies before.
  void keep_energies();
  void limit_energies();
  // What the contacts of the next step may have to carry (ModelInstance::load_near).
  void note_loads();
  // Groups that lie still fall asleep.
  void settle();
  void clear();

 private:
  struct Member {
    ModelInstance* model = nullptr;
    std::uint32_t parent = 0;
    double energy = 0;  // [J] before the step
    // Of the whole group, at its root.
    bool has_mesh = false, is_exempt = false, is_deep = false, may_sleep = true;
    GroupSize size;
    std::uint32_t contacts = 0;
    double gained = 0, motion = 0;  // [J] by the step; that it moves with now
    double work = 0;                // [J] of the forces on its bodies
  };
  // On one body, for the step.
  struct Push {
    dBodyID body = nullptr;
    std::uint32_t member = 0;
    Eigen::Vector3d force, torque, linear, angular;  // velocities before the step
    double work(double dt) const;                    // [J] after it
  };
  void note_pushes(std::uint32_t member);
  std::uint32_t root(std::uint32_t i);
  void join(const ModelInstance& a, const ModelInstance& b);
  void slow_down_what_gained();

  const PhysicsDef& physics_;
  std::vector<Member> members_;
  std::vector<Push> pushes_;
  bool has_mesh_ = false;
  std::uint32_t contacts_ = 0;
};

}  // namespace sim
