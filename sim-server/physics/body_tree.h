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
    int parent = -1, tree = -1;
    JointInstance* joint = nullptr;
    bool touches = false;  // it or what hangs on it has a contact, or follows another joint
    Matrix6 mass;
    Vector6 momentum;  // without any joint, after the step
    JointRows rows;
    Vector6 impulse, velocity;

   private:
    friend class BodyTree;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor, JointRows::most, 6>;
    using Few = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, JointRows::most, 1>;
    using FewSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, JointRows::most, JointRows::most>;
    // Of the tree as far as it hangs on this one.
    Matrix6 joined, inverse;
    Rows answer, pull;  // rows times inverse; what the parent's velocity takes from the impulses
    Rows own, parent_side;
    Few target;
    FewSquare inverse_give;
    Few share;  // the impulses of the free rows
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

  // Contacts and the like act on it. After the last: gather_trees().
  void mark_touched(int node);
  void gather_trees();

  void factor();
  // The impulses on the nodes: their momenta, and what the bound rows of joints give.
  void load();
  // Velocities of the impulses on the nodes and the targets of the rows.
  void sweep();
  // The same without targets, for what leads to contacts alone, and of some trees.
  void sweep_touched(const std::vector<int>& trees);
  void clear_touched(const std::vector<int>& trees);
  void clear_touched();
  // Motors that cannot do what they are to, and stops that need not hold, are at their bounds. False: all are right as they are.
  bool bind_joints(bool one_at_a_time);
  bool is_finite() const;

 private:
  static void gather(Node& node);
  void pull_up(Node& node, bool is_homogeneous);
  void push_down(Node& node);

  std::vector<Node> nodes_;  // the first `count_`; storage is kept from step to step
  std::size_t count_ = 0;
  std::vector<std::pair<dBodyID, int>> places_;  // sorted
  std::vector<std::vector<int>> trees_;          // nodes that touch, by tree, in their order
};

}  // namespace sim
