#include "planner_device.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/log.h"
#include "protocol/payloads.h"

namespace gateway {
namespace {

constexpr double spare_room = 0.05;     // [m] around the robot
constexpr double near_a_corner = 0.15;  // [m] from a way point that is not the last

player::Pose2d to_player(const shm::PlanarPose& pose) { return {pose.x, pose.y, pose.a}; }

base::Result<std::vector<shm::MapPlace>> planned(const base::Result<shm::Reply>& reply, const shm::MapPlace& from, const shm::MapPlace& to,
                                                 double radius) {
  if (!reply) return reply.error();
  shm::MapOptions options;
  options.places = {from, to};
  options.max_cells = 2000;
  options.may_coarsen = true;
  const auto map = shm::make_map(reply->text, options);
  if (!map) return map.error();
  return shm::plan_path(*map, from, to, radius);
}

}  // namespace

// A circle that holds the robot in any heading, as far as its shape is known.
double Planner::radius() const {
  const auto& size = iface().info<shm::Position2dInfo>().size;
  return std::hypot(size[0], size[1]) / 2 + spare_room;
}

std::optional<shm::PlanarPose> Planner::pose() const {
  if (!companion() || !companion()->has_sample()) return std::nullopt;
  const auto& p = companion()->iface().sample<shm::TruthSample>().pose;
  return shm::PlanarPose{p.x, p.y, shm::yaw_of(p)};
}

void Planner::obey(Client& client, std::uint8_t, const std::string& payload) {
  const auto goal = player::decode_pose2d(payload);
  if (!goal || !std::isfinite(goal->x) || !std::isfinite(goal->y) || !std::isfinite(goal->a)) return;
  if (iface().info<shm::Position2dInfo>().drive == RTMSIM_DRIVE_CAR) {
    base::log(base::Level::warn, "player-gateway", "planner of {}: a car cannot turn on the spot; the goal is ignored", iface().name());
    return;
  }
  const bool is_known = wish_ && pursuer_ == &client && wish_->goal.x == goal->x && wish_->goal.y == goal->y && wish_->goal.a == goal->a;
  if (is_known && !is_done_) return;  // some say it again and again
  stop();
  end();
  pursuer_ = &client;
  wish_ = Wish{{goal->x, goal->y, goal->a}, ++goals_};
  if (pose()) plan();  // else with the first sample
}

void Planner::plan() {
  const auto now = *pose();
  const auto way = std::make_shared<base::Result<std::vector<shm::MapPlace>>>(base::Error{""});
  const shm::MapPlace from{now.x, now.y}, to{wish_->goal.x, wish_->goal.y};
  constexpr double farthest = 1e4;  // [m]
  if (std::hypot(to[0] - from[0], to[1] - from[1]) > farthest)
    return take(wish_->number, base::Error{fmt::format("the goal is more than {} m away", farthest)});
  wish_->is_asked = true;
  services_.long_requests.post(
      shm::ExportRequest{true},
      [weak = std::weak_ptr(self_), way, number = wish_->number](const base::Result<shm::Reply>&) {
        if (const auto self = weak.lock()) (*self)->take(number, *way);
      },
      AsyncRequests::limit,
      [way, from, to, room = radius()](const base::Result<shm::Reply>& reply) { *way = planned(reply, from, to, room); });
}

void Planner::take(std::uint64_t number, const base::Result<std::vector<shm::MapPlace>>& way) {
  if (!wish_ || wish_->number != number) return;
  if (!way) {
    base::log(base::Level::warn, "player-gateway", "planner of {}: {}", source() ? iface().name() : "", way.error().message);
    wish_->is_asked = true;
    return;
  }
  way_ = *way;
  next_ = 0;
  leg_.reset();
}

// Headings point along the way; at the goal it is the one that is wanted.
shm::PlanarPose Planner::waypoint(std::size_t index) const {
  if (index + 1 >= way_.size()) return wish_->goal;
  const auto &here = way_[index], &next = way_[index + 1];
  return {here[0], here[1], std::atan2(next[1] - here[1], next[0] - here[0])};
}

void Planner::go_on(const shm::Position2dSample& sample, const shm::PlanarPose& now) {
  if (way_.empty() || is_done_ || !is_enabled_) return;
  if (resets_.value_or(sample.stamp.resets) != sample.stamp.resets || (is_driving_ && !iface().is_commanding())) {
    stop();
    return end();
  }
  resets_ = sample.stamp.resets;
  const auto distance = [&] { return std::hypot(way_[next_][0] - now.x, way_[next_][1] - now.y); };
  while (next_ + 1 < way_.size() && distance() < near_a_corner) ++next_, leg_.reset();
  if (!leg_) leg_.emplace(waypoint(next_), shm::within({}, iface().info<shm::Position2dInfo>()));
  const auto velocity = leg_->next(now);
  if (!command_velocity(*pursuer_, std::array{velocity.x, velocity.y, velocity.a})) return;
  is_driving_ = true;
  if (!leg_->has_arrived()) return;
  leg_.reset();
  is_done_ = next_ + 1 == way_.size();
  if (is_done_) {
    is_driving_ = false;
  } else {
    ++next_;
  }
}

void Planner::show_sample() {
  const auto now = pose();
  const auto& sample = iface().sample<shm::Position2dSample>();
  if (!now) return;
  if (wish_ && !wish_->is_asked) plan();
  if (!is_for_newcomer()) go_on(sample, *now);
  player::PlannerState state;
  state.is_valid = !way_.empty();
  state.is_done = is_done_;
  state.pose = to_player(*now);
  if (wish_) state.goal = to_player(wish_->goal);
  if (!way_.empty() && !is_done_) {
    state.waypoint = to_player(waypoint(next_));
    state.index = static_cast<std::int32_t>(next_);
  }
  state.count = static_cast<std::uint32_t>(way_.size());
  publish(1, player::encode(state), sample.stamp);
}

std::optional<Answer> Planner::answer(std::uint8_t subtype, const std::string& payload, const Later&) {
  constexpr std::uint8_t get_waypoints = 1;
  if (subtype == get_waypoints) {
    std::vector<player::Pose2d> points;
    double length = 0;
    for (std::size_t i = 0; i < way_.size(); ++i) {
      points.push_back(to_player(waypoint(i)));
      if (i > 0) length += std::hypot(points[i].x - points[i - 1].x, points[i].y - points[i - 1].y);
    }
    return ack(player::encode_waypoints(length, points));
  }
  const auto state = player::decode_byte(payload);
  if (!state) return nack();
  is_enabled_ = *state != 0;
  if (!is_enabled_) stop();
  return ack();
}

void Planner::stop() {
  if (is_driving_ && pursuer_ != nullptr && source() && iface().is_commanding()) command_velocity(*pursuer_, std::array{0.0, 0.0, 0.0});
  is_driving_ = false;
  leg_.reset();
}

void Planner::end() {
  wish_.reset();
  way_.clear();
  leg_.reset();
  resets_.reset();
  next_ = 0;
  is_done_ = is_driving_ = false;
  pursuer_ = nullptr;
}

void Planner::forget(Client& client) {
  if (pursuer_ == &client) end();
  Drive::forget(client);
}

}  // namespace gateway
