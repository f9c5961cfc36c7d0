#include "leader_tracker.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace follow {
namespace {

double distance(const Point& a, const Point& b) { return std::hypot(a.x - b.x, a.y - b.y); }

Point to_outer(const Pose& frame, const Point& p) {
  return {frame.x + std::cos(frame.a) * p.x - std::sin(frame.a) * p.y, frame.y + std::sin(frame.a) * p.x + std::cos(frame.a) * p.y};
}

}  // namespace

std::vector<Cluster> find_clusters(const Scan& scan, const Pose& mount, double jump) {
  constexpr std::size_t fewest = 3;  // points
  std::vector<Cluster> clusters;
  Point sum, first, before;
  std::size_t count = 0;
  const auto end_cluster = [&] {
    if (count >= fewest) {
      Cluster& done = clusters.back();
      done.centre = {sum.x / static_cast<double>(count), sum.y / static_cast<double>(count)};
      done.width = distance(first, before);
    } else if (count > 0) {
      clusters.pop_back();
    }
    count = 0;
    sum = {};
  };
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = scan.ranges[i], angle = scan.min_angle + static_cast<double>(i) * scan.angle_step;
    if (!(range < scan.max_range)) {
      end_cluster();
      continue;
    }
    const Point point = to_outer(mount, {range * std::cos(angle), range * std::sin(angle)});
    if (count > 0 && distance(point, before) >= jump) end_cluster();
    if (count == 0) {
      clusters.push_back({.centre = {}, .width = 0, .first = i, .last = i});
      first = point;
    }
    clusters.back().last = i;
    before = point;
    sum = {sum.x + point.x, sum.y + point.y};
    ++count;
  }
  end_cluster();
  return clusters;
}

std::optional<double> LeaderTracker::unseen(double time) const { return place_ ? std::optional(time - seen_at_) : std::nullopt; }

bool LeaderTracker::has_jumped(const Pose& odometry, double time) const {
  if (!last_time_) return false;
  const double passed = time - *last_time_;
  if (passed < 0) return true;
  const double driven = std::hypot(odometry.x - last_odometry_.x, odometry.y - last_odometry_.y);
  const double turned = std::abs(std::remainder(odometry.a - last_odometry_.a, 2 * std::numbers::pi));
  constexpr double fastest_turn = 2;  // [rad/s]: twice what it is told at most
  return driven > settings_.odometry_jump + 2 * settings_.max_speed * passed || turned > settings_.odometry_jump + fastest_turn * passed;
}

std::optional<Sighting> LeaderTracker::update(const Scan& scan, const Pose& mount, const Pose& odometry, double time) {
  if (has_jumped(odometry, time)) place_.reset();
  last_odometry_ = odometry;
  last_time_ = time;
  if (place_ && time - seen_at_ > settings_.forget) place_.reset();
  const double gate = place_ ? settings_.gate + settings_.max_speed * (time - seen_at_) : 0;
  const Cluster* best = nullptr;
  double best_cost = std::numeric_limits<double>::infinity();
  const auto clusters = find_clusters(scan, mount, settings_.jump);
  for (const Cluster& cluster : clusters) {
    double cost = 0;
    if (place_) {
      cost = distance(to_outer(odometry, cluster.centre), *place_);
      if (cost > gate || cluster.width > settings_.widest) continue;
    } else {
      cost = std::hypot(cluster.centre.x, cluster.centre.y);
      const double bearing = std::atan2(cluster.centre.y, cluster.centre.x);
      if (std::abs(bearing) > settings_.max_bearing || cluster.width < settings_.min_width || cluster.width > settings_.max_width) continue;
    }
    if (cost >= best_cost) continue;
    best = &cluster;
    best_cost = cost;
  }
  if (best == nullptr) return std::nullopt;
  place_ = to_outer(odometry, best->centre);
  seen_at_ = time;
  return Sighting{std::hypot(best->centre.x, best->centre.y), std::atan2(best->centre.y, best->centre.x), best->first, best->last};
}

}  // namespace follow
