// The rows of contacts, of joints that follow others, and of welds, between bodies of trees: solved on what the trees answer at the bodies
// that they act on. Friction is bounded by what presses on the contact in the end. SI units; impulses of one step. Private to physics/. One
// thread at a time.
//
// Source: J. Judice, F. Pires, Block principal pivoting for linear complementarity with bounds (1994).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "physics/body_tree.h"
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

class TreeContacts {
 public:
  TreeContacts(BodyTree& tree, dWorldID world, const PhysicsDef& physics) : tree_(tree), world_(world), physics_(physics) {}

  void clear() { touches_.clear(), rows_.clear(), tie_rows_ = 0; }
  // Of a model in the tree. Ties come before all contacts.
  void add_mimics(ModelInstance& model);
  void add_weld(Weld& weld);
  void add(const MadeContact& contact);

  // With the velocities that the nodes have without these rows. `is_first`: of the step; then the rows begin free, else as they were
  // found. False: nothing was found.
  bool solve(bool is_first);
  bool is_empty() const { return rows_.empty(); }
  // Puts the impulses on the nodes; those of contacts are told to their feedback as well.
  void press() const;
  void press_and_tell() const;

 private:
  struct Push {
    int node = -1;
    Vector6 on = Vector6::Zero();
  };
  struct Row {
    std::array<Push, 4> pushes;  // on two bodies; of a joint that follows another one on those of the leader, too
    double target = 0, give = 0;
    double low = 0, high = infinite;
    double friction = 0;  // times the impulse of `normal` is the bound; 0: bounds as they are
    int normal = -1;
  };
  struct Touch {
    const MadeContact* contact = nullptr;
    int a = -1, b = -1;                // nodes
    std::size_t first = 0, count = 0;  // rows
    std::array<Eigen::Vector3d, 3> lines;
  };
  // What the rows do to one node.
  struct Act {
    Eigen::Index row = 0;
    Vector6 on;
  };
  struct Acted {
    int node = -1;
    std::vector<Act> acts;
  };
  void add_row(Touch& touch, const Eigen::Vector3d& line, const Row& row);
  double target_of(const MadeContact& contact) const;
  double motion(const Row& row) const;
  void add_answers(const Acted& at, const Acted& from);
  void ask_tree(bool is_first);
  void gather_acts();
  bool rub_and_press();

  BodyTree& tree_;
  dWorldID world_;
  const PhysicsDef& physics_;
  std::vector<Touch> touches_;
  std::vector<Row> rows_;     // first those of joints that follow others, and of welds
  std::size_t tie_rows_ = 0;  // of these
  std::vector<Acted> acted_;  // the first `acted_count_`; storage is kept from step to step
  std::size_t acted_count_ = 0;
  std::vector<Bound> bounds_;  // of the last round
  BoundedSystem system_;
};

}  // namespace sim
