// Bodies that joints hold together, and what an impulse on one of them does to all: the joints' rates that are locked stay as they are.
// Motors, springs and stops are left out. Private to physics/; the stepping thread of the shard.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "physics/ode.h"

namespace sim {

inline bool is_pushable(dBodyID body) { return body != nullptr && dBodyIsKinematic(body) == 0; }

class JoinedBodies {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;  // linear, angular; of a body, in the world

  // All that joints lead to from `first`, which can be pushed, but for contacts.
  explicit JoinedBodies(dBodyID first);

  // False: joints of kinds that are not known here, or too many.
  bool are_known() const { return are_known_; }
  const std::vector<dBodyID>& bodies() const { return bodies_; }
  int place_of(dBodyID body) const;  // in bodies(); -1: it is not there
  // Changes of the velocities of all, one below the other, by impulses on all.
  Eigen::VectorXd response(const Eigen::VectorXd& impulses) const;

 private:
  void add_rows(dJointID joint);
  void add_row(dJointID joint, const Eigen::Vector3d& line, const Eigen::Vector3d& place);  // relative speed at a place, along a line
  void add_turn_row(dJointID joint, const Eigen::Vector3d& line);
  void add_halves(dJointID joint, const Vector6& first, const Vector6& second);
  Eigen::VectorXd freely(const Eigen::VectorXd& impulses) const;  // without joints

  std::vector<dBodyID> bodies_;
  std::vector<Eigen::Matrix3d> inverse_inertias_;  // in the world
  std::vector<double> inverse_masses_;
  std::vector<Eigen::VectorXd> rows_, answers_;  // on the velocities; of the bodies to the rows
  Eigen::LDLT<Eigen::MatrixXd> locked_;
  bool are_known_ = true;
};

}  // namespace sim
