// Chooses the solver for models that touch each other: an exact one if its work is acceptable, otherwise ODE's iterative one. Estimates
// from counts and masses alone, so that every machine chooses alike. Pure; any thread.
//
// An exact solution is worth 20 times the work of an iterative one: arms and legs hold their position, while 50 iterations let a hand of
// ten joints sink by 0.37 m in a second. Beyond that a step costs tens of milliseconds: a humanoid of 75 bodies that lies in the ground.
//
// A heap is solved exactly, too, when one of its models weighs more than twenty times as much as another. An iteration carries no more of
// the load than the weight of the lighter one, and 100 t sink through a plate of 1 kg.
#pragma once

#include <algorithm>
#include <cstdint>

#include "world/world_def.h"

namespace sim {

struct GroupSize {
  std::uint32_t bodies = 0, joint_rows = 0;  // of the constraints that joints make
  std::uint32_t contact_rows = 0;
  std::uint32_t moving_contacts = 0;  // between models that both move
  bool has_many_joints = false;       // a model of at least TreeSolver::least_bodies
  bool has_trees_only = true;
  bool is_ill_conditioned = false;    // rounding takes more of its matrix than softness puts in
  double lightest = 0, heaviest = 0;  // [kg] of its models
  double mass = 0;                    // [kg] of all

  bool is_uneven() const { return heaviest > 20 * lightest; }

  GroupSize& operator+=(const GroupSize& other) {
    bodies += other.bodies, joint_rows += other.joint_rows;
    contact_rows += other.contact_rows, moving_contacts += other.moving_contacts;
    is_ill_conditioned = is_ill_conditioned || other.is_ill_conditioned;
    lightest = std::min(lightest, other.lightest), heaviest = std::max(heaviest, other.heaviest), mass += other.mass;
    has_many_joints = has_many_joints || other.has_many_joints, has_trees_only = has_trees_only && other.has_trees_only;
    return *this;
  }
};

struct SolverChoice {
  bool is_iterative = false;    // where TreeSolver is not tried or finds nothing
  bool is_tree_solved = false;  // TreeSolver is tried first
};

// Whether ODE's exact solver would meet pivots that are 0 or below, with which it ends the process. `compliance` [1/kg]: how far a push on
// a contact moves and turns its body; `cfm` [1/kg]: what softness adds to it.
bool is_ill_conditioned(double compliance, double cfm);

SolverChoice choose_solver(const PhysicsDef& physics, const GroupSize& group);

}  // namespace sim
