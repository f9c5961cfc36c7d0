#include "physics/solver_choice.h"

#include <algorithm>

namespace sim {
namespace {

// Moving bodies that lie on each other: there the exact solver's handling of friction goes wrong (a stack of ten boxes falls at once).
constexpr std::uint32_t stacked_contacts = 4;
constexpr double worth = 20;  // an exact solution, of the work of an iterative one

// Works in nanoseconds of the machine that they were measured on, of which only the ratios count (physics_bench prints them).

// One dense matrix of all rows is factored; those of contacts are then put in and taken out one by one.
double dense_work(double joint_rows, double contact_rows) {
  const double rows = joint_rows + contact_rows;
  return 0.045 * rows * rows * rows + 0.15 * contact_rows * rows * rows;
}

// The tree is swept once for each row of a contact, and a dense matrix of these rows is factored for each round of friction.
double tree_work(double bodies, double contact_rows) {
  return 2000 * bodies + 60 * bodies * contact_rows + 4 * contact_rows * contact_rows * contact_rows;
}

double iterative_work(double rows, double iterations) { return 18 * rows * iterations; }

}  // namespace

bool is_ill_conditioned(double compliance, double cfm) {
  constexpr double rounding = 1e-13;       // of a sum of some hundred terms
  return !(compliance * rounding <= cfm);  // nor when it is no number
}

SolverChoice choose_solver(const PhysicsDef& physics, const GroupSize& group) {
  using Solver = PhysicsDef::Solver;
  if (physics.solver == Solver::iterative || group.is_ill_conditioned) return {.is_iterative = true};
  const double joints = group.joint_rows, contacts = group.contact_rows;
  const double most = worth * iterative_work(joints + contacts, std::clamp(physics.iterations, 1, 10000));
  const bool has_stack = group.moving_contacts >= stacked_contacts && !group.is_uneven();
  const bool is_heap = has_stack || dense_work(joints, contacts) > most;
  return {.is_iterative = physics.solver == Solver::automatic && is_heap,
          .is_tree_solved = group.has_many_joints && group.has_trees_only && tree_work(group.bodies, contacts) <= most};
}

}  // namespace sim
