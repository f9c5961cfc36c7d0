#include "devices/drives/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "devices/angle.h"
#include "devices/device.h"

namespace sim {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double same_place = 1e-6;  // [m]

double heading_of(const Eigen::Vector3d& way) { return std::atan2(way.y(), way.x()); }
double flat(const Eigen::Vector3d& way) { return way.head<2>().norm(); }

base::Result<std::vector<Eigen::Vector3d>> read_points(const ParameterNode& list, const PluginDef& plugin, double height) {
  std::vector<Eigen::Vector3d> points;
  for (const auto& child : list.children) {
    if (child.name != "waypoint") continue;
    std::string text = child.text;
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
    const auto parts = base::split_list(text, ' ');
    Eigen::Vector3d point(0, 0, height);
    bool is_good = parts.size() == 2 || parts.size() == 3;
    for (std::size_t i = 0; is_good && i < parts.size(); ++i) {
      const auto number = base::parse_number(parts[i]);
      is_good = number && std::isfinite(*number) && std::abs(*number) < 1e6;
      if (is_good) point[static_cast<Eigen::Index>(i)] = *number;
    }
    if (!is_good) {
      return base::Error{fmt::format("{}: plugin {}: waypoint {}: expected x y or x y z in metres", plugin.source, plugin.name,
                                     base::in_quotes(child.text))};
    }
    if (points.empty() || (points.back() - point).norm() > same_place) points.push_back(point);
  }
  return points;
}

}  // namespace

Eigen::Isometry3d Path::inside(const Piece& piece, double seconds) {
  const double heading = piece.heading + piece.turn * seconds;
  Eigen::Vector3d moved(0, 0, piece.climb * seconds);
  if (std::abs(piece.turn) < 1e-12) {
    moved.x() = piece.speed * seconds * std::cos(heading);
    moved.y() = piece.speed * seconds * std::sin(heading);
  } else {
    const double radius = piece.speed / piece.turn;
    moved.x() = radius * (std::sin(heading) - std::sin(piece.heading));
    moved.y() = radius * (std::cos(piece.heading) - std::cos(heading));
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = piece.from + moved;
  pose.linear() = Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

Eigen::Isometry3d Path::at(double seconds) const {
  seconds -= delay_;
  if (seconds <= 0 || (lead_.empty() && loop_.empty())) return start_;
  const std::vector<Piece>* pieces = &lead_;
  if (seconds >= lead_seconds_ && !loop_.empty()) {
    pieces = &loop_;
    seconds = std::fmod(seconds - lead_seconds_, loop_seconds_);
  }
  for (const auto& piece : *pieces) {
    if (seconds < piece.seconds) return inside(piece, seconds);
    seconds -= piece.seconds;
  }
  return inside(pieces->back(), pieces->back().seconds);
}

void Path::turn(std::vector<Piece>& to, const Eigen::Vector3d& at, double& heading, double angle) const {
  if (std::abs(angle) < 1e-9) return;
  to.push_back({std::abs(angle) / turn_rate_, at, heading, 0, 0, std::copysign(turn_rate_, angle)});
  heading += angle;
}

void Path::line(std::vector<Piece>& to, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double& heading) const {
  const Eigen::Vector3d way = b - a;
  if (way.norm() < same_place) return;
  if (flat(way) > same_place) {
    turn(to, a, heading, wrapped(heading_of(way) - heading));
    heading = heading_of(way);
  }
  const double seconds = way.norm() / speed_;
  to.push_back({seconds, a, heading, flat(way) / seconds, way.z() / seconds, 0});
}

Path::Corner Path::round(const Eigen::Vector3d& before, const Eigen::Vector3d& at, const Eigen::Vector3d& after, double radius) const {
  const Eigen::Vector3d in = at - before, out = after - at;
  const double angle = wrapped(heading_of(out) - heading_of(in)), half = std::tan(std::abs(angle) / 2);
  if (flat(in) < same_place || flat(out) < same_place || half < 1e-9 || half > 1e3 || radius <= 0) return {at, at, 0, angle};
  const double most = 0.5 * std::min(flat(in), flat(out));  // half of each side belongs to the next corner
  const double cut = std::min(radius * half, most);
  Corner corner{at - in * (cut / flat(in)), at + out * (cut / flat(out)), cut / half, angle};
  return corner;
}

void Path::corner(std::vector<Piece>& to, const Corner& corner, double& heading) const {
  if (corner.radius <= 0) return;  // the next line turns on the spot
  const double length = corner.radius * std::abs(corner.angle), seconds = length / speed_;
  to.push_back({seconds, corner.in, heading, speed_, (corner.out.z() - corner.in.z()) / seconds, corner.angle / seconds});
  heading += corner.angle;
}

void Path::follow(const std::vector<Eigen::Vector3d>& points, bool is_loop, double corner_radius) {
  const std::size_t count = points.size();
  double heading = yaw_of(start_);
  line(lead_, start_.translation(), points[0], heading);
  if (count == 1) return;
  const auto rounded = [&](std::size_t i) {
    return round(points[(i + count - 1) % count], points[i], points[(i + 1) % count], corner_radius);
  };
  if (!is_loop) {
    Eigen::Vector3d from = points[0];
    for (std::size_t i = 1; i < count; ++i) {
      const Corner next = i + 1 < count ? rounded(i) : Corner{points[i], points[i], 0, 0};
      line(lead_, from, next.in, heading);
      corner(lead_, next, heading);
      from = next.out;
    }
    return;
  }
  // The loop begins behind the first corner, where each round comes by.
  const Corner first = rounded(0);
  line(lead_, points[0], first.out, heading);
  if (first.radius <= 0) turn(lead_, points[0], heading, wrapped(heading_of(points[1] - points[0]) - heading));
  Eigen::Vector3d from = first.out;
  for (std::size_t i = 1; i <= count; ++i) {
    const Corner next = i < count ? rounded(i) : first;
    line(loop_, from, next.in, heading);
    corner(loop_, next, heading);
    from = next.out;
  }
  if (first.radius <= 0) turn(loop_, from, heading, wrapped(heading_of(points[1] - points[0]) - heading));
}

base::Result<Path> Path::of(const PluginDef& plugin, const Eigen::Isometry3d& start) {
  const ParameterNode& p = plugin.parameters;
  const auto fail = [&](const std::string& what) {
    return base::Error{fmt::format("{}: plugin {}: {}", plugin.source, plugin.name, what)};
  };
  Path path;
  path.start_ = start;
  path.speed_ = p.number_of({"speed", "velocity"}).value_or(1);
  path.turn_rate_ = p.number_of({"turn_rate"}).value_or(1.57);
  path.delay_ = p.number_of({"delay_start"}).value_or(0);
  if (!(path.speed_ > 0 && path.speed_ <= 100))
    return fail(fmt::format("speed {}: expected a number above 0, at most 100 m/s", path.speed_));
  if (!(path.turn_rate_ > 0 && path.turn_rate_ <= 100))
    return fail(fmt::format("turn_rate {}: expected a number above 0, at most 100 rad/s", path.turn_rate_));
  if (!(path.delay_ >= 0)) return fail(fmt::format("delay_start {}: expected a number of seconds, 0 or more", path.delay_));

  const Eigen::Vector3d origin = start.translation(), forward = start.linear().col(0);
  if (const ParameterNode* circle = p.child("circle")) {
    const double radius = circle->number_of({"radius"}).value_or(0);
    if (!(radius > 0 && radius < 1e6)) return fail(fmt::format("circle: radius {}: expected a number above 0 m", radius));
    double heading = yaw_of(start);
    const Eigen::Vector3d first = origin + Eigen::Vector3d(radius, 0, 0);
    path.line(path.lead_, origin, first, heading);
    path.turn(path.lead_, first, heading, wrapped(pi / 2 - heading));
    path.loop_.push_back({2 * pi * radius / path.speed_, first, heading, path.speed_, 0, path.speed_ / radius});
  } else if (const ParameterNode* line = p.child("line")) {
    const double length = line->number_of({"length"}).value_or(0);
    if (!(length > 0 && length < 1e6)) return fail(fmt::format("line: length {}: expected a number above 0 m", length));
    path.follow({origin, origin + length * forward}, true, 0);
  } else if (const ParameterNode* list = p.child("waypoints")) {
    const auto points = read_points(*list, plugin, origin.z());
    if (!points) return points.error();
    const bool is_loop = p.bool_of({"loop"}).value_or(false);
    auto all = *points;
    if (is_loop && all.size() > 1 && (all.front() - all.back()).norm() <= same_place) all.pop_back();
    if (all.empty()) return fail("waypoints: expected one <waypoint> or more");
    path.follow(all, is_loop && all.size() > 1, std::max(0.0, p.number_of({"corner_radius"}).value_or(0)));
  } else {
    return fail("expected <waypoints>, <line> or <circle>");
  }
  for (const auto& piece : path.lead_) path.lead_seconds_ += piece.seconds;
  for (const auto& piece : path.loop_) path.loop_seconds_ += piece.seconds;
  return path;
}

}  // namespace sim
