// Kinematics and inverse dynamics of the joints of a model with one axis each, as a tree on a base that does not move. SI units; frames of
// the base: the model's. Joints of other kinds, and those that are not in the list, are rigid as at the start. Values; any thread.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "world/world_def.h"

namespace sim {

class JointDynamics {
 public:
  // `joints`: indexes into ModelDef::joints, each with one axis.
  JointDynamics(const ModelDef& model, std::span<const std::uint32_t> joints);

  struct Body {
    int parent = -1;                                              // number of the joint that carries this one; -1: the base
    Eigen::Isometry3d in_parent = Eigen::Isometry3d::Identity();  // joint frame at position 0, in the parent's
    Eigen::Vector3d axis{0, 0, 1};                                // unit, in the joint's frame
    bool slides = false;
    double mass = 0;  // of all links that move with the joint, without what further joints carry
    Eigen::Vector3d center_of_mass{0, 0, 0};
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre of mass
  };
  std::size_t size() const { return bodies_.size(); }
  const Body& body(std::size_t joint) const { return bodies_[joint]; }

  // Frames of the joints in the base's.
  void poses(std::span<const double> positions, std::vector<Eigen::Isometry3d>& out) const;
  // Recursive Newton-Euler: efforts that these motions need. Empty spans are zeros.
  void efforts(std::span<const double> positions, std::span<const double> velocities, std::span<const double> accelerations,
               const Eigen::Vector3d& gravity, std::span<double> out) const;
  // A joint's own entry of the mass matrix: what an effort of it alone has to move.
  double inertia(std::span<const double> positions, std::size_t joint) const;
  // Largest effort that gravity of this strength can ask for, whatever the positions.
  double max_gravity_effort(std::size_t joint, double gravity) const;

 private:
  std::vector<Body> bodies_;
  std::vector<std::size_t> order_;  // parents first
};

}  // namespace sim
