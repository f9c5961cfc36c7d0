// The exact step of models with many joints: their joints by the tree that they make, from the ends to the root and back, in a time that
// grows with their number, where ODE's exact solver factors one dense matrix of all rows (cubic). Contacts are solved on what the tree
// answers at the bodies that touch. The rows are those that ODE has for hinges, sliders, balls, welds and contacts; what comes out is put
// on the bodies as forces, and ODE moves them with these joints switched off.
//
// Differs from dWorldStep in two things: a motor that holds a joint at its stop has a row of its own, and friction is bounded by what
// presses on the contact in the end, not by what would without friction. Private to physics/. One thread at a time.
//
// Sources: D. Baraff, Linear-time dynamics using Lagrange multipliers (1996); J. Judice, F. Pires, Block principal pivoting for linear
// complementarity with bounds (1994).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "physics/bounded_system.h"
#include "physics/model_instance.h"
#include "physics/ode.h"

namespace sim {

// A contact of the step, as it was given to ODE.
struct MadeContact {
  dJointID joint = nullptr;
  dContact contact{};
  dBodyID a = nullptr, b = nullptr;  // `a` always is; both may be kinematic
  ModelInstance* model = nullptr;    // of `a`
  dJointFeedback* feedback = nullptr;
};

class TreeSolver {
 public:
  // Fewer bodies are no slower with ODE's dense matrix.
  static constexpr std::size_t least_bodies = 12;

  TreeSolver(dWorldID world, const PhysicsDef& physics) : world_(world), physics_(physics) {}

  // Models that touch each other, all with trees, and all their contacts. On true the bodies have the forces of joints and contacts for
  // the next step, and these are switched off until let_go(). False, and nothing has changed: the forces were not found.
  bool solve(const std::vector<ModelInstance*>& models, const std::vector<const MadeContact*>& contacts);
  void let_go();

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;  // linear, angular
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  static constexpr int most_rows = 7;  // of a joint: six of a weld; five, a motor and a stop
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor, most_rows, 6>;
  using Few = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, most_rows, 1>;
  using FewSquare = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_rows, most_rows>;

  struct Row {
    Vector6 own, parent;  // on the velocities of the body and of what it hangs on
    double target = 0, give = 0;
    double low = -infinite, high = infinite;  // of its impulse
    Bound bound = Bound::free;
    double impulse = 0;
    bool is_free() const { return bound == Bound::free; }
  };
  struct Node {
    dBodyID body = nullptr;
    int parent = -1, tree = -1;
    JointInstance* joint = nullptr;
    int motor_row = -1;
    bool is_child = false, touches = false;  // touches: it or what hangs on it has a contact, or follows another joint
    Vector6 axis_own, axis_parent;           // of a joint with one axis: its rate, from the velocities of the two bodies
    Matrix6 mass;
    Vector6 momentum;  // without any joint, after the step
    std::vector<Row> rows;
    // Of the tree as far as it hangs on this one.
    Matrix6 joined, inverse;
    Rows answer, pull;  // rows times inverse; what the parent's velocity takes from the impulses
    Rows own, parent_side;
    Few target;
    FewSquare inverse_give;
    // Of one solution.
    Vector6 impulse, velocity;
    Few share;
  };
  struct Touch {
    const MadeContact* contact = nullptr;
    int a = -1, b = -1;  // nodes
    std::vector<std::size_t> rows;
    std::vector<Eigen::Vector3d> lines;
  };
  struct ContactRow {
    int a = -1, b = -1;
    Vector6 on_a, on_b;
    int c = -1, d = -1;  // of a joint that follows another one: the two bodies of the leader
    Vector6 on_c = Vector6::Zero(), on_d = Vector6::Zero();
    double target = 0, give = 0;
    double low = 0, high = infinite;
    double friction = 0;  // times the impulse of `normal` is the bound; 0: bounds as they are
    int normal = -1;
  };

  void add_model(ModelInstance& model);
  void add_joint(Node& node);
  void add_row(Node& node, const Vector6& on_child, const Vector6& on_parent, double target, double give, double low, double high);
  void add_axis(Node& node, const Vector6& of_child, const Vector6& of_parent);
  void add_contact(const MadeContact& contact);
  void add_mimics(ModelInstance& model, std::size_t first);
  void add_weld(Weld& weld);
  void mark_touched(int node);
  void add_contact_row(Touch& touch, const Eigen::Vector3d& line, const ContactRow& row);
  int node_of(dBodyID body) const;

  void factor();
  void gather(Node& node);
  void gather_trees();
  void sweep();
  void sweep_trees(const std::vector<int>& trees);
  void pull_up(Node& node, bool is_homogeneous);
  void push_down(Node& node);
  void solve_contacts(bool is_first);
  bool rub_and_press();
  void load(bool has_contacts);
  void press(const ContactRow& row, double impulse);
  bool bind_joints(bool one_at_a_time);
  bool is_finite() const;
  void put_forces();
  void switch_off(dJointID joint);

  dWorldID world_;
  const PhysicsDef& physics_;
  std::vector<Node> nodes_;
  std::vector<Touch> touches_;
  std::vector<ContactRow> rows_;                 // first those of joints that follow others, and of welds
  std::size_t tie_rows_ = 0;                     // of these
  std::vector<std::pair<dBodyID, int>> places_;  // sorted
  std::vector<std::vector<int>> trees_;          // nodes that touch, by tree, in their order
  std::vector<int> swept_;                       // trees that one row moves
  BoundedSystem system_;
  std::vector<dJointID> switched_off_;
};

}  // namespace sim
