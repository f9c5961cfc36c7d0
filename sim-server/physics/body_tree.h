// The bodies of models as trees that their joints make, and their answer to impulses: from the ends to the root and back, in a time that
// grows with their number. Rows that are at a bound act with a given impulse, the free ones with what keeps their velocity. SI units; the
// impulses and velocities of one step. Private to physics/. One thread at a time.
//
// Source: D. Baraff, Linear-time dynamics using Lagrange multipliers (1996).
#pragma once

#include <Eigen/Core>
#include <span>
#include <utility>
#include <vector>

#include "physics/model_instance.h"
#include "physics/tree_rows.h"

namespace sim {

class BodyTree {
 public:
  struct Node {
    dBodyID body = nullptr;
    int parent = -1, root = -1;
    JointInstance* joint = nullptr;
    bool touches = false;  // it or what hangs on it has a contact, or follows another joint
    Matrix6 mass;
    Vector6 momentum;  // without any joint, after the step
    JointRows rows;
    Vector6 impulse, velocity;

   private:
    friend class BodyTree;
    using Rows = Eigen::Matrix<double, JointRows::most, 6, Eigen::RowMajor>;
    using Few = Eigen::Matrix<double, JointRows::most, 1>;
    // Of the tree as far as it hangs on this one.
    Matrix6 joined, inverse;
    Rows answer, pull;  // rows times inverse; what the parent's velocity takes from the impulses
    Rows own, parent_side;
    Few target, give;
    Eigen::Matrix<double, JointRows::most, JointRows::most> inverse_give;
    Few share;     // the impulses of the free rows
    int free = 0;  // rows; those behind them, up to the size that is computed with, are zeros
    // Where it touches: the velocity that an impulse on it gives it while the parent stands still, the impulse that comes to the parent,
    // and the velocity while the parent moves, too.
    Matrix6 alone, passed_on, whole;
  };

  void clear();
  void add_model(ModelInstance& model, const PhysicsDef& physics, dWorldID world);
  // After the last model.
  void sort();
  // -1: not one of these.
  int node_of(dBodyID body) const;
  int node_of(const JointInstance& joint) const;
  std::span<Node> nodes() { return {nodes_.data(), count_}; }
  std::span<const Node> nodes() const { return {nodes_.data(), count_}; }
  Node& at(int node) { return nodes_[static_cast<std::size_t>(node)]; }
  const Node& at(int node) const { return nodes_[static_cast<std::size_t>(node)]; }

  // Contacts and the like act on it.
  void mark_touched(int node);

  void factor();
  // The impulses on the nodes: their momenta, and what the bound rows of joints give.
  void load();
  // Velocities of the impulses on the nodes and the targets of the rows.
  void sweep();
  // After factor(): for answer() at nodes that are touched.
  void prepare_answers();
  // What an impulse on node `from` does to the velocity of node `at` of the same tree.
  Matrix6 answer(int at, int from) const;
  // Motors that cannot do what they are to, and stops that need not hold, are at their bounds. False: all are right as they are.
  bool bind_joints(bool one_at_a_time);
  bool is_finite() const;

 private:
  static void gather(Node& node);
  template <int rows>
  void factor_rows(Node& node);
  template <int rows>
  static void prepare_answer(Node& node);
  void pull_up(Node& node);
  void push_down(Node& node);

  std::vector<Node> nodes_;  // the first `count_`; storage is kept from step to step
  std::size_t count_ = 0;
  std::vector<std::pair<dBodyID, int>> places_;  // sorted
};

}  // namespace sim
