// The exact step of models with many joints: their joints by the tree that they make (body_tree.h), where ODE's exact solver factors one
// dense matrix of all rows (cubic). Contacts are solved on what the tree answers at the bodies that touch (tree_contacts.h). The rows are
// those that ODE has for hinges, sliders, balls, welds and contacts; what comes out is put on the bodies as forces, and ODE moves them with
// these joints switched off.
//
// Differs from dWorldStep in two things: a motor that holds a joint at its stop has a row of its own, and friction is bounded by what
// presses on the contact in the end, not by what would without friction. Private to physics/. One thread at a time.
#pragma once

#include <vector>

#include "physics/body_tree.h"
#include "physics/tree_contacts.h"

namespace sim {

class TreeSolver {
 public:
  // Fewer bodies are no slower with ODE's dense matrix.
  static constexpr std::size_t least_bodies = 12;

  TreeSolver(dWorldID world, const PhysicsDef& physics) : world_(world), physics_(physics), contacts_(tree_, world, physics) {}
  TreeSolver(const TreeSolver&) = delete;
  TreeSolver& operator=(const TreeSolver&) = delete;

  // Models that touch each other, all with trees, and all their contacts. On true the bodies have the forces of joints and contacts for
  // the next step, and these are switched off until let_go(). False, and nothing has changed: the forces were not found.
  bool solve(const std::vector<ModelInstance*>& models, const std::vector<const MadeContact*>& contacts);
  void let_go();

 private:
  void make(const std::vector<ModelInstance*>& models, const std::vector<const MadeContact*>& contacts);
  void put_forces();
  void put_joint_forces(BodyTree::Node& node);
  void switch_off(dJointID joint);

  dWorldID world_;
  const PhysicsDef& physics_;
  BodyTree tree_;
  TreeContacts contacts_;
  std::vector<dJointID> switched_off_;
};

}  // namespace sim
