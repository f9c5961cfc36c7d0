#include "arms/arm_kinematics.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

namespace arms {
namespace {

constexpr double rotation_weight = 0.3;                  // [m/rad]
constexpr double near_singular = 0.05;                   // of the smallest singular value
constexpr double longest_step = 0.1, widest_step = 0.3;  // [m], [rad] of error that one step takes on
constexpr double goal_error = 1e-9;                      // [m], [rad] at which the search ends
constexpr double accepted_error = 1e-6;                  // [m], [rad] of a solution
constexpr int max_steps = 200;
constexpr double no_limit = 2 * M_PI;                         // of starting positions for joints without limits
constexpr std::array other_parts{0.5, 0.35, 0.65, 0.2, 0.8};  // of the way between the limits, where the search starts again

bool is_within(const Eigen::Matrix<double, 6, 1>& error, double most) {
  return error.head<3>().norm() < most && error.tail<3>().norm() < most;
}

}  // namespace

Eigen::Matrix<double, 6, 1> difference(const Eigen::Isometry3d& goal, const Eigen::Isometry3d& from) {
  const Eigen::AngleAxisd turn(goal.linear() * from.linear().transpose());
  Eigen::Matrix<double, 6, 1> out;
  out << goal.translation() - from.translation(), turn.angle() * turn.axis();
  return out;
}

bool is_chain(std::span<const shm::Joint> joints) {
  for (std::size_t i = 1; i < joints.size(); ++i) {
    if (joints[i].parent != joints[i - 1].id + 1) return false;
  }
  return !joints.empty();
}

ArmKinematics::ArmKinematics(std::span<const shm::Joint> joints) {
  for (const shm::Joint& joint : joints) {
    Joint made{Eigen::Isometry3d::Identity(),
               {joint.axis[0], joint.axis[1], joint.axis[2]},
               joint.kind == RTMSIM_JOINT_SLIDES,
               joint.lower,
               joint.upper};
    made.place.translation() = Eigen::Vector3d(joint.pose.x, joint.pose.y, joint.pose.z);
    made.place.linear() = Eigen::Quaterniond(joint.pose.qw, joint.pose.qx, joint.pose.qy, joint.pose.qz).toRotationMatrix();
    joints_.push_back(made);
  }
}

std::vector<Eigen::Isometry3d> ArmKinematics::frames(std::span<const double> positions) const {
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Isometry3d> out;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    at = at * joints_[i].place;
    if (joints_[i].slides) {
      at.translate(positions[i] * joints_[i].axis);
    } else {
      at.rotate(Eigen::AngleAxisd(positions[i], joints_[i].axis));
    }
    out.push_back(at);
  }
  return out;
}

Eigen::Isometry3d ArmKinematics::tip(std::span<const double> positions) const {
  return joints_.empty() ? Eigen::Isometry3d::Identity() : frames(positions).back();
}

// Damped only near a singular pose. Joints that are fixed get 0.
Eigen::VectorXd ArmKinematics::step_towards(const Vector6& error, const std::vector<Eigen::Isometry3d>& frames,
                                            const std::vector<bool>& is_fixed) const {
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(6, joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Eigen::Vector3d axis = frames[i].linear() * joints_[i].axis;
    auto column = jacobian.col(static_cast<Eigen::Index>(i));
    if (is_fixed[i]) {
      column.setZero();
    } else if (joints_[i].slides) {
      column << axis, Eigen::Vector3d::Zero();
    } else {
      column << axis.cross(frames.back().translation() - frames[i].translation()), rotation_weight * axis;
    }
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& values = svd.singularValues();
  const double least = values.minCoeff();
  const double damping = least < near_singular ? near_singular * std::pow(1 - least / near_singular, 2) : 0;
  const Eigen::VectorXd shares = svd.matrixU().transpose() * error;
  Eigen::VectorXd scaled(values.size());
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const double denominator = values[k] * values[k] + damping * damping;
    scaled[k] = denominator > 1e-18 ? shares[k] * values[k] / denominator : 0;
  }
  return svd.matrixV() * scaled;
}

// One step; false when the joints cannot come nearer. A joint that would pass its limit stays there, and the others make up for it.
bool ArmKinematics::improve(const Eigen::Isometry3d& goal, std::vector<double>& positions) const {
  const auto all = frames(positions);
  Vector6 error = difference(goal, all.back());
  if (const double size = error.head<3>().norm(); size > longest_step) error.head<3>() *= longest_step / size;
  if (const double size = error.tail<3>().norm(); size > widest_step) error.tail<3>() *= widest_step / size;
  error.tail<3>() *= rotation_weight;
  std::vector<bool> is_fixed(joints_.size(), false);
  for (std::size_t round = 0; round <= joints_.size(); ++round) {
    const Eigen::VectorXd step = step_towards(error, all, is_fixed);
    bool has_new = false;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const double next = positions[i] + step[static_cast<Eigen::Index>(i)];
      if (is_fixed[i] || (next >= joints_[i].low && next <= joints_[i].high)) continue;
      positions[i] = std::clamp(next, joints_[i].low, joints_[i].high);
      is_fixed[i] = has_new = true;
    }
    if (has_new) continue;
    for (std::size_t i = 0; i < joints_.size(); ++i) positions[i] += step[static_cast<Eigen::Index>(i)];
    return step.norm() > 1e-12;
  }
  return false;
}

std::optional<std::vector<double>> ArmKinematics::solve_near(const Eigen::Isometry3d& goal, std::span<const double> from) const {
  if (joints_.empty()) return std::nullopt;
  std::vector<double> positions(from.begin(), from.end());
  for (std::size_t i = 0; i < joints_.size(); ++i) positions[i] = std::clamp(positions[i], joints_[i].low, joints_[i].high);
  for (int step = 0; step < max_steps; ++step) {
    if (is_within(difference(goal, tip(positions)), goal_error)) return positions;
    if (!improve(goal, positions)) break;
  }
  if (is_within(difference(goal, tip(positions)), accepted_error)) return positions;
  return std::nullopt;
}

std::vector<double> ArmKinematics::other_start(std::size_t which) const {
  const double part = other_parts[which];
  std::vector<double> start;
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const double low = std::max(joints_[i].low, -no_limit), high = std::min(joints_[i].high, no_limit);
    start.push_back(low + (i % 2 == 0 ? part : 1 - part) * (high - low));
  }
  return start;
}

std::optional<std::vector<double>> ArmKinematics::solve(const Eigen::Isometry3d& goal, std::span<const double> from) const {
  if (auto found = solve_near(goal, from)) return found;
  for (std::size_t i = 0; i < other_parts.size(); ++i) {
    if (auto found = solve_near(goal, other_start(i))) return found;
  }
  return std::nullopt;
}

std::optional<std::vector<double>> ArmKinematics::solve_place(const Eigen::Vector3d& place, const Eigen::Vector3d& point,
                                                              std::span<const double> from) const {
  const auto search = [&](std::vector<double> positions) -> std::optional<std::vector<double>> {
    constexpr double damping = 0.01;
    for (int step = 0; step < max_steps && !joints_.empty(); ++step) {
      const auto all = frames(positions);
      const Eigen::Vector3d at = all.back() * point;
      Eigen::Vector3d error = place - at;
      if (error.norm() < accepted_error) return positions;
      if (error.norm() > longest_step) error *= longest_step / error.norm();
      Eigen::Matrix3Xd jacobian(3, joints_.size());
      for (std::size_t i = 0; i < joints_.size(); ++i) {
        const Eigen::Vector3d axis = all[i].linear() * joints_[i].axis;
        jacobian.col(static_cast<Eigen::Index>(i)) = joints_[i].slides ? axis : axis.cross(at - all[i].translation());
      }
      const Eigen::Matrix3d squared = jacobian * jacobian.transpose() + damping * damping * Eigen::Matrix3d::Identity();
      const Eigen::VectorXd change = jacobian.transpose() * squared.ldlt().solve(error);
      for (std::size_t i = 0; i < joints_.size(); ++i)
        positions[i] = std::clamp(positions[i] + change[static_cast<Eigen::Index>(i)], joints_[i].low, joints_[i].high);
    }
    return std::nullopt;
  };
  if (auto found = search({from.begin(), from.end()})) return found;
  for (std::size_t i = 0; i < other_parts.size(); ++i) {
    if (auto found = search(other_start(i))) return found;
  }
  return std::nullopt;
}

}  // namespace arms
