#include "path_follower.h"

#include <algorithm>
#include <cmath>

bool PathFollower::set(const RTC::Waypoint2DList& path) {
  constexpr CORBA::ULong most = 10000;
  if (path.length() > most) return false;
  std::vector<RTC::Waypoint2D> points;
  for (CORBA::ULong i = 0; i < path.length(); ++i) {
    const RTC::Waypoint2D& point = path[i];
    for (const double value : {point.target.position.x, point.target.position.y, point.target.heading, point.distanceTolerance,
                               point.headingTolerance, point.maxSpeed.vx, point.maxSpeed.va}) {
      if (!std::isfinite(value)) return false;
    }
    points.push_back(point);
  }
  state_.lock()->fresh = std::move(points);
  return true;
}

void PathFollower::SetPath(const RTC::Waypoint2DList& path) {
  if (!set(path)) throw CORBA::BAD_PARAM();
}

const RTC::Waypoint2D* PathFollower::current(const State& state) {
  const auto& path = state.fresh ? *state.fresh : state.path;
  const std::size_t index = state.fresh ? 0 : state.index;
  return index < path.size() ? &path[index] : nullptr;
}

CORBA::UShort PathFollower::GetCurrentWaypointIndex() {
  constexpr CORBA::UShort none = 65535;
  auto state = state_.lock();
  if (current(*state) == nullptr) return none;
  return state->fresh ? CORBA::UShort{0} : static_cast<CORBA::UShort>(state->index);
}

RTC::Waypoint2D PathFollower::GetCurrentWaypoint() {
  {
    auto state = state_.lock();
    if (const auto* point = current(*state)) return *point;
  }
  throw CORBA::BAD_INV_ORDER();
}

bool PathFollower::take_news() {
  auto state = state_.lock();
  if (!state->fresh) return false;
  state->path = std::move(*state->fresh);
  state->fresh.reset();
  state->index = 0;
  leg_.reset();
  return true;
}

void PathFollower::end() {
  auto state = state_.lock();
  state->path.clear();
  leg_.reset();
}

std::optional<shm::PlanarPose> PathFollower::next(const shm::PlanarPose& odometry, const shm::Position2dInfo& robot) {
  auto state = state_.lock();
  for (; state->index < state->path.size(); ++state->index, leg_.reset()) {
    if (!state->is_enabled) return shm::PlanarPose{};
    const RTC::Waypoint2D& point = state->path[state->index];
    const auto& [position, heading] = point.target;
    const bool is_near = std::hypot(position.x - odometry.x, position.y - odometry.y) <= point.distanceTolerance &&
                         std::abs(std::remainder(heading - odometry.a, 2 * std::acos(-1.0))) <= point.headingTolerance;
    if (is_near) continue;
    if (!leg_) {
      shm::DriveLimits limits;
      if (point.maxSpeed.vx > 0) limits.speed = point.maxSpeed.vx;
      if (point.maxSpeed.va > 0) limits.turn = point.maxSpeed.va;
      leg_.emplace(shm::PlanarPose{position.x, position.y, heading}, shm::within(limits, robot));
    }
    const auto velocity = leg_->next(odometry);
    if (!leg_->has_arrived()) return velocity;
  }
  state->path.clear();
  return std::nullopt;
}
