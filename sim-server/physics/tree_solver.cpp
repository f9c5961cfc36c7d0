#include "physics/tree_solver.h"

#include "physics/weld.h"

namespace sim {

void TreeSolver::make(const std::vector<ModelInstance*>& models, const std::vector<const MadeContact*>& contacts) {
  tree_.clear();
  contacts_.clear();
  for (auto* model : models) {
    tree_.add_model(*model, physics_, world_);
    contacts_.add_mimics(*model);
  }
  tree_.sort();
  for (auto* model : models) {
    for (Weld* weld : model->welds) {
      if (weld->is_counted_for(*model)) contacts_.add_weld(*weld);
    }
  }
  for (const auto* contact : contacts) contacts_.add(*contact);
}

bool TreeSolver::solve(const std::vector<ModelInstance*>& models, const std::vector<const MadeContact*>& contacts) {
  constexpr int at_once = 10, max_rounds = 40;
  make(models, contacts);
  for (int round = 0; round < max_rounds; ++round) {
    tree_.factor();
    tree_.load();
    tree_.sweep();
    if (!contacts_.is_empty()) {
      if (!contacts_.solve(round == 0)) return false;
      tree_.load();
      contacts_.press();
      tree_.sweep();
    }
    if (!tree_.is_finite()) return false;
    if (tree_.bind_joints(round >= at_once)) continue;
    put_forces();
    for (auto* model : models) {
      for (Weld* weld : model->welds) {
        if (weld->is_counted_for(*model)) switch_off(weld->prepare(world_));
      }
    }
    return true;
  }
  return false;
}

void TreeSolver::put_forces() {
  const double per_step = 1 / physics_.step;
  for (auto& node : tree_.nodes()) node.impulse.setZero();
  for (auto& node : tree_.nodes()) {
    if (node.joint != nullptr) put_joint_forces(node);
  }
  contacts_.press_and_tell();
  for (const auto& node : tree_.nodes()) {
    const Vector6 w = per_step * node.impulse;
    dBodyAddForce(node.body, w[0], w[1], w[2]);
    dBodyAddTorque(node.body, w[3], w[4], w[5]);
  }
}

void TreeSolver::put_joint_forces(BodyTree::Node& node) {
  const double per_step = 1 / physics_.step;
  const auto copy = [](const Vector6& from, dReal* force, dReal* torque) {
    for (int i = 0; i < 3; ++i) force[i] = from[i], torque[i] = from[i + 3];
  };
  if (const TreeRow* motor = node.rows.motor()) node.joint->motor_bound = motor->bound;
  Vector6 own = Vector6::Zero(), parent = Vector6::Zero();
  for (const TreeRow& row : node.rows) own += row.own * row.impulse, parent += row.parent * row.impulse;
  node.impulse += own;
  if (node.parent >= 0) tree_.at(node.parent).impulse += parent;
  const dJointID joint = node.joint->id();
  if (auto* feedback = dJointGetFeedback(joint)) {
    const bool is_first = dJointGetBody(joint, 0) == node.body;
    if (node.parent < 0) parent.setZero();
    copy(per_step * (is_first ? own : parent), feedback->f1, feedback->t1);
    copy(per_step * (is_first ? parent : own), feedback->f2, feedback->t2);
  }
  switch_off(joint);
}

void TreeSolver::switch_off(dJointID joint) {
  dJointDisable(joint);
  switched_off_.push_back(joint);
}

void TreeSolver::let_go() {
  for (const dJointID joint : switched_off_) dJointEnable(joint);
  switched_off_.clear();
}

}  // namespace sim
