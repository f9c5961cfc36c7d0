#include "devices/actor_motion.h"

#include <algorithm>
#include <cmath>

namespace sim {
namespace {

// A smooth curve through p1 and p2 that looks at their neighbours; tension 1 makes it straight.
Eigen::Vector3d curve(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1, const Eigen::Vector3d& p2, const Eigen::Vector3d& p3,
                      double tension, double u) {
  const Eigen::Vector3d m1 = (1 - tension) * 0.5 * (p2 - p0) + tension * (p2 - p1);
  const Eigen::Vector3d m2 = (1 - tension) * 0.5 * (p3 - p1) + tension * (p2 - p1);
  const double u2 = u * u, u3 = u2 * u;
  return (2 * u3 - 3 * u2 + 1) * p1 + (u3 - 2 * u2 + u) * m1 + (3 * u2 - 2 * u3) * p2 + (u3 - u2) * m2;
}

}  // namespace

// The way points of all trajectories in turn, each on the clock of the whole.
ActorMotion::ActorMotion(const ActorDef& actor) : actor_(actor) {
  double begin = 0;
  for (std::size_t t = 0; t < actor.trajectories.size(); ++t) {
    for (auto waypoint : actor.trajectories[t].waypoints) {
      waypoint.time += begin;
      if (points_.empty() || waypoint.time > points_.back().place.time) points_.push_back({waypoint, t, begin, {}});
    }
    if (!points_.empty()) begin = points_.back().place.time;
  }
  // A path that ends where it begins has no corner there.
  is_closed_ = actor.loop && points_.size() > 2 &&
               (points_.front().place.pose.translation() - points_.back().place.pose.translation()).norm() < 1e-6;
  for (std::size_t end = 1; end < points_.size(); ++end) {
    auto& walked = points_[end].walked;
    walked[0] = points_[end - 1].walked.back();
    for (std::size_t k = 1; k <= pieces; ++k) {
      const auto place = [&](std::size_t n) { return on_segment(end, static_cast<double>(n) / pieces); };
      walked[k] = walked[k - 1] + (place(k) - place(k - 1)).norm();
    }
  }
}

Eigen::Vector3d ActorMotion::on_segment(std::size_t end, double share) const {
  const std::size_t last = points_.size() - 1;
  const auto place = [&](std::size_t k) -> Eigen::Vector3d { return points_[k].place.pose.translation(); };
  const Eigen::Vector3d before = end >= 2 ? place(end - 2) : is_closed_ ? place(last - 1) : place(end - 1);
  const Eigen::Vector3d after = end < last ? place(end + 1) : is_closed_ ? place(1) : place(end);
  return curve(before, place(end - 1), place(end), after, std::clamp(actor_.trajectories.front().tension, 0.0, 1.0), share);
}

std::optional<std::size_t> ActorMotion::animation_of(std::size_t trajectory) const {
  for (std::size_t i = 0; i < actor_.animations.size(); ++i) {
    if (actor_.animations[i].name == actor_.trajectories[trajectory].animation) return i;
  }
  return std::nullopt;
}

ActorMoment ActorMotion::at(double seconds) const {
  ActorMoment out;
  out.pose = actor_.pose;
  seconds = actor_.auto_start ? std::max(seconds - actor_.delay_start, 0.0) : 0;
  const bool has_begun = actor_.auto_start && seconds > 0;
  if (points_.empty()) {
    // Plays where it stands.
    if (!actor_.animations.empty()) out.animation = 0;
    out.seconds = seconds;
    return out;
  }
  out.animation = animation_of(points_.front().trajectory);
  if (!has_begun && actor_.delay_start > 0) return out;
  if (!actor_.auto_start) return out;
  const double length = points_.back().place.time;
  if (actor_.loop && length > 0) {
    out.distance = std::floor(seconds / length) * points_.back().walked.back();
    seconds = std::fmod(seconds, length);
  }
  const auto next = std::upper_bound(points_.begin(), points_.end(), seconds, [](double t, const Point& p) { return t < p.place.time; });
  if (next == points_.begin() || points_.size() == 1) {
    out.pose = points_.front().place.pose;
    out.seconds = std::min(seconds, points_.front().place.time);
    return out;
  }
  if (next == points_.end()) {
    const Point& last = points_.back();
    out.pose = last.place.pose;
    out.animation = animation_of(last.trajectory);
    out.seconds = length - last.begin;
    out.distance += last.walked.back();
    return out;
  }
  const auto end = static_cast<std::size_t>(next - points_.begin());
  const Point &from = points_[end - 1], &to = points_[end];
  const double share = (seconds - from.place.time) / (to.place.time - from.place.time);
  out.pose = Eigen::Isometry3d::Identity();
  out.pose.translation() = on_segment(end, share);
  out.pose.linear() =
      Eigen::Quaterniond(from.place.pose.linear()).slerp(share, Eigen::Quaterniond(to.place.pose.linear())).toRotationMatrix();
  out.animation = animation_of(to.trajectory);
  out.seconds = seconds - to.begin;
  const double piece = share * pieces;
  const auto k = std::min(static_cast<std::size_t>(piece), pieces - 1);
  out.distance += to.walked[k] + (piece - static_cast<double>(k)) * (to.walked[k + 1] - to.walked[k]);
  return out;
}

}  // namespace sim
