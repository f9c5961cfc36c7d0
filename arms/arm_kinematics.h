// Kinematics of a chain of joints: the pose of its tip, and joint positions for a pose by damped least squares. Equal arguments give equal
// results: no random numbers, no time limit. Units: m, rad. Values; any thread.
#pragma once

#include <shm/iface_types.h>

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

namespace arms {

class ArmKinematics {
 public:
  ArmKinematics() = default;
  // From base to tip; each joint is carried by the one before.
  explicit ArmKinematics(std::span<const shm::Joint> joints);

  std::size_t size() const { return joints_.size(); }
  // Of the last joint's frame, in the frame that carries the first joint.
  Eigen::Isometry3d tip(std::span<const double> positions) const;
  // Positions within the limits of the joints, on the branch of `from` where there is one. Nothing: no solution was found.
  std::optional<std::vector<double>> solve(const Eigen::Isometry3d& goal, std::span<const double> from) const;
  // The same without a search from other positions: for the next point of a path.
  std::optional<std::vector<double>> solve_near(const Eigen::Isometry3d& goal, std::span<const double> from) const;
  // The same for a point of the last joint's frame alone, with any orientation.
  std::optional<std::vector<double>> solve_place(const Eigen::Vector3d& place, const Eigen::Vector3d& point,
                                                 std::span<const double> from) const;

 private:
  struct Joint {
    Eigen::Isometry3d place;
    Eigen::Vector3d axis;
    bool slides;
    double low, high;
  };
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  std::vector<Eigen::Isometry3d> frames(std::span<const double> positions) const;
  Eigen::VectorXd step_towards(const Vector6& error, const std::vector<Eigen::Isometry3d>& frames, const std::vector<bool>& is_fixed) const;
  // From other positions than the usual ones, within the limits; 0 <= which < other_starts.
  std::vector<double> other_start(std::size_t which) const;
  bool improve(const Eigen::Isometry3d& goal, std::vector<double>& positions) const;

  std::vector<Joint> joints_;
};

// Whether each joint is carried by the one before; false without joints.
bool is_chain(std::span<const shm::Joint> joints);

// From one pose to another: translation and rotation vector, in the frame of both.
Eigen::Matrix<double, 6, 1> difference(const Eigen::Isometry3d& goal, const Eigen::Isometry3d& from);

}  // namespace arms
