#include "arms/planner.h"

#include <base/text.h>

#include <algorithm>
#include <cmath>

namespace arms {
namespace {

constexpr double point_every = 0.005;  // [s] of a Cartesian path
constexpr double max_points = 4000;
constexpr double widest_jump = 0.5;  // [rad] between two points of a path: the joints change to another branch

Plan no_plan(std::string comment) { return {wrong_value(std::move(comment)), {}}; }

Eigen::Isometry3d turned(Eigen::Isometry3d pose, const Eigen::Vector3d& rotation, double part) {
  const double angle = rotation.norm();
  if (angle > 0) pose.linear() = Eigen::AngleAxisd(part * angle, rotation / angle) * pose.linear();
  return pose;
}

// The arc through three points. The sweep is counted from the first one to the last one, by way of the second.
struct Arc {
  Eigen::Vector3d center, x, y;
  double sweep = 0;
  Eigen::Vector3d at(double part) const { return center + std::cos(part * sweep) * x + std::sin(part * sweep) * y; }
};

std::optional<Arc> arc_through(const Eigen::Vector3d& a, const Eigen::Vector3d& via, const Eigen::Vector3d& end) {
  const Eigen::Vector3d u = via - a, v = end - a, normal = u.cross(v);
  if (normal.norm() < 1e-6 * u.norm() * v.norm() || normal.norm() < 1e-12) return std::nullopt;
  Arc arc;
  arc.center = a + (u.squaredNorm() * v.cross(normal) + v.squaredNorm() * normal.cross(u)) / (2 * normal.squaredNorm());
  arc.x = a - arc.center;
  arc.y = normal.normalized().cross(arc.x);
  const double angle = std::atan2((end - arc.center).dot(arc.y), (end - arc.center).dot(arc.x));
  arc.sweep = angle < 0 ? angle + 2 * M_PI : angle;
  return arc;
}

}  // namespace

Reply wrong_value(std::string comment) { return {Answer::wrong_value, std::move(comment)}; }

std::string number_text(double value) {
  return std::isnan(value) ? "nan" : std::isinf(value) ? (value < 0 ? "-inf" : "inf") : base::format_number(value);
}

bool is_rotation(const Eigen::Matrix3d& matrix) {
  constexpr double tolerance = 1e-3;
  return matrix.allFinite() && (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < tolerance &&
         matrix.determinant() > 0;
}

Eigen::Isometry3d Planner::pose(std::span<const double> positions) const {
  return settings_.base * kinematics_.tip(positions) * settings_.tool;
}

Reply Planner::check_joints(std::span<const double> goal) const {
  if (goal.size() != axes()) return wrong_value("expected " + std::to_string(axes()) + " joints, got " + std::to_string(goal.size()));
  for (std::size_t i = 0; i < goal.size(); ++i) {
    const Range& limit = settings_.limits[i];
    if (!limit.contains(goal[i]) || std::isinf(goal[i]))
      return wrong_value("joint " + std::to_string(i + 1) + ": expected " + number_text(limit.low) + " to " + number_text(limit.high) +
                         " [rad or m], got " + number_text(goal[i]));
  }
  return {};
}

Reply Planner::check_pose(const Eigen::Isometry3d& pose) const {
  if (!is_rotation(pose.linear())) return wrong_value("the rotation part of the matrix is not a rotation");
  for (int k = 0; k < 3; ++k) {
    const Range& limit = settings_.box[static_cast<std::size_t>(k)];
    if (!limit.contains(pose.translation()[k]))
      return wrong_value(std::string(1, static_cast<char>('x' + k)) + ": expected " + number_text(limit.low) + " to " +
                         number_text(limit.high) + " [m], got " + number_text(pose.translation()[k]));
  }
  return {};
}

Reply Planner::check_cartesian_speed() const {
  return settings_.cartesian_ratio > 0 ? Reply{} : wrong_value("the Cartesian speed is 0 %; setSpeedCartesian sets it");
}

Plan Planner::to_joints(const std::vector<double>& from, const std::vector<double>& goal, bool is_relative) const {
  std::vector<double> end = goal;
  for (std::size_t i = 0; is_relative && end.size() == axes() && i < end.size(); ++i) end[i] += from[i];
  if (Reply value = check_joints(end); !value.is_ok()) return {value, {}};
  if (Reply value = check_pose(pose(end)); !value.is_ok()) return {value, {}};
  if (!(settings_.joint_ratio > 0)) return no_plan("the joint speed is 0 %; setSpeedJoint sets it");
  Trapezoid slowest;
  for (std::size_t i = 0; i < axes(); ++i) {
    const auto one = Trapezoid::of(end[i] - from[i], settings_.joint_ratio * settings_.max_speeds[i], settings_.joint_time);
    if (one.duration > slowest.duration) slowest = one;
  }
  return {{}, Motion({from, end}, slowest)};
}

std::optional<std::vector<double>> Planner::joints_at(const Eigen::Isometry3d& pose, std::span<const double> from, bool is_path) const {
  const Eigen::Isometry3d tip = settings_.base.inverse() * pose * settings_.tool.inverse();
  return is_path ? kinematics_.solve_near(tip, from) : kinematics_.solve(tip, from);
}

// A matrix that is almost a rotation is made one; others are left for check_pose.
Eigen::Isometry3d Planner::goal_of(const std::vector<double>& from, const Eigen::Isometry3d& goal, bool is_relative) const {
  Eigen::Isometry3d clean = goal;
  if (is_rotation(goal.linear())) clean.linear() = Eigen::Quaterniond(goal.linear()).normalized().toRotationMatrix();
  if (!is_relative) return clean;
  Eigen::Isometry3d end = pose(from);
  end.linear() = clean.linear() * end.linear();
  end.translation() += clean.translation();
  return end;
}

Plan Planner::to_pose(const std::vector<double>& from, const Eigen::Isometry3d& goal, bool is_relative) const {
  const Eigen::Isometry3d end = goal_of(from, goal, is_relative);
  if (Reply value = check_pose(end); !value.is_ok()) return {value, {}};
  std::optional<std::vector<double>> joints = joints_at(end, from, false);
  // Soft limits can be narrower than those that the kinematics know.
  if (!joints || !check_joints(*joints).is_ok()) return no_plan("the arm cannot reach the pose within its limits");
  return to_joints(from, *joints, false);
}

int Planner::points_of(double length, double turn) const {
  const double time = std::max(length / (settings_.cartesian_ratio * settings_.max_translation),
                               turn / (settings_.cartesian_ratio * settings_.max_rotation));
  return static_cast<int>(std::clamp(std::ceil(time / point_every), 8.0, max_points));
}

// The poses are at equal parts of the way. The path is slowed down where a joint would be too fast.
Plan Planner::follow(const std::vector<double>& from, const Way& way) const {
  std::vector<std::vector<double>> points{from};
  for (std::size_t k = 1; k < way.poses.size(); ++k) {
    if (Reply value = check_pose(way.poses[k]); !value.is_ok()) return {value, {}};
    std::optional<std::vector<double>> joints = joints_at(way.poses[k], points.back(), true);
    if (!joints) return no_plan("the arm cannot reach every pose of the path");
    if (Reply value = check_joints(*joints); !value.is_ok()) return {value, {}};
    for (std::size_t i = 0; i < axes(); ++i) {
      if (std::abs((*joints)[i] - points.back()[i]) > widest_jump)
        return no_plan("the path passes a singular pose at joint " + std::to_string(i + 1));
    }
    points.push_back(std::move(*joints));
  }
  const auto along = Trapezoid::of(way.length, settings_.cartesian_ratio * settings_.max_translation, settings_.cartesian_time);
  const auto around = Trapezoid::of(way.turn, settings_.cartesian_ratio * settings_.max_rotation, settings_.cartesian_time);
  Motion motion(std::move(points), along.duration >= around.duration ? along : around);
  double longer = 1;
  const auto speeds = motion.speeds();
  for (std::size_t i = 0; i < axes(); ++i) longer = std::max(longer, speeds[i] / settings_.max_speeds[i]);
  if (longer > 1) motion.stretch(longer * motion.duration());
  return {{}, std::move(motion)};
}

Plan Planner::along_line(const std::vector<double>& from, const Eigen::Isometry3d& goal, bool is_relative) const {
  const Eigen::Isometry3d start = pose(from), end = goal_of(from, goal, is_relative);
  if (Reply value = check_pose(end); !value.is_ok()) return {value, {}};
  if (Reply value = check_cartesian_speed(); !value.is_ok()) return {value, {}};
  const auto change = difference(end, start);
  Way way{change.head<3>().norm(), change.tail<3>().norm(), {}};
  const int count = points_of(way.length, way.turn);
  for (int k = 0; k <= count; ++k) {
    const double part = static_cast<double>(k) / count;
    Eigen::Isometry3d pose = turned(start, change.tail<3>(), part);
    pose.translation() += part * change.head<3>();
    way.poses.push_back(pose);
  }
  return follow(from, way);
}

Plan Planner::along_arc(const std::vector<double>& from, const Eigen::Isometry3d& via, const Eigen::Isometry3d& goal,
                        bool is_relative) const {
  const Eigen::Isometry3d start = pose(from), middle = goal_of(from, via, is_relative), end = goal_of(from, goal, is_relative);
  for (const auto& pose : {middle, end}) {
    if (Reply value = check_pose(pose); !value.is_ok()) return {value, {}};
  }
  if (Reply value = check_cartesian_speed(); !value.is_ok()) return {value, {}};
  const auto arc = arc_through(start.translation(), middle.translation(), end.translation());
  if (!arc) return no_plan("the start, the via point and the goal are on one line");
  const Eigen::Vector3d rotation = difference(end, start).tail<3>();
  Way way{arc->sweep * arc->x.norm(), rotation.norm(), {}};
  const int count = points_of(way.length, way.turn);
  for (int k = 0; k <= count; ++k) {
    const double part = static_cast<double>(k) / count;
    Eigen::Isometry3d pose = turned(start, rotation, part);
    pose.translation() = arc->at(part);
    way.poses.push_back(pose);
  }
  return follow(from, way);
}

}  // namespace arms
