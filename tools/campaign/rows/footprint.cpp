#include "campaign/rows/footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace campaign {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length = along.squaredNorm();
  const double t = length > 0 ? std::clamp((p - a).dot(along) / length, 0.0, 1.0) : 0.0;
  return (p - a - t * along).norm();
}

// Whether a line along an edge of `a` has the other one wholly on its outer side.
bool is_apart_along(const Polygon& a, const Polygon& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d edge = a[(i + 1) % a.size()] - a[i];
    if (std::ranges::all_of(b, [&](const Eigen::Vector2d& p) { return cross(edge, p - a[i]) < 0; })) return true;
  }
  return false;
}

double from_corners(const Polygon& a, const Polygon& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& p : a) {
    for (std::size_t i = 0; i < b.size(); ++i) least = std::min(least, to_segment(p, b[i], b[(i + 1) % b.size()]));
  }
  return least;
}

}  // namespace

Polygon hull(std::vector<Eigen::Vector2d> points) {
  std::ranges::sort(points, [](const auto& a, const auto& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  if (points.size() < 3) return points;
  Polygon all(2 * points.size());
  std::size_t n = 0;
  const auto add = [&](const Eigen::Vector2d& p, std::size_t least) {
    while (n >= least && cross(all[n - 1] - all[n - 2], p - all[n - 2]) <= 0) --n;
    all[n++] = p;
  };
  for (const auto& p : points) add(p, 2);
  const auto lower = n + 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  all.resize(n - 1);
  return all;
}

std::vector<Polygon> footprint(const Outline& outline, const Eigen::Isometry3d& pose) {
  std::vector<Polygon> polygons;
  for (const auto& part : outline.parts) {
    std::vector<Eigen::Vector2d> points;
    for (const auto& corner : part) points.emplace_back((pose * corner).head<2>());
    polygons.push_back(hull(std::move(points)));
  }
  return polygons;
}

double distance(const Polygon& a, const Polygon& b) {
  if (a.empty() || b.empty()) return std::numeric_limits<double>::infinity();
  if (a.size() > 2 && b.size() > 2 && !is_apart_along(a, b) && !is_apart_along(b, a)) return 0;
  return std::min(from_corners(a, b), from_corners(b, a));
}

double distance(const std::vector<Polygon>& a, const std::vector<Polygon>& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& one : a) {
    for (const auto& other : b) least = std::min(least, distance(one, other));
  }
  return least;
}

Eigen::Isometry3d to_pose(const std::vector<double>& numbers) {
  const auto at = [&](std::size_t i) { return i < numbers.size() ? numbers[i] : 0.0; };
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(at(0), at(1), at(2));
  pose.linear() = (Eigen::AngleAxisd(at(5), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(at(4), Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(at(3), Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

}  // namespace campaign
