#include "path_follower.h"

#include <shm/requests.h>

#include <algorithm>
#include <cmath>

std::vector<double> numbers_of(const RTC::Waypoint2D& point) {
  const auto& [position, heading] = point.target;
  return {position.x, position.y, heading, point.distanceTolerance, point.headingTolerance, point.maxSpeed.vx, point.maxSpeed.va};
}

std::vector<double> numbers_of(const RTC::Waypoint3D& point) {
  const auto& [at, turn] = point.target;
  return {at.x, at.y, at.z, turn.r, turn.p, turn.y, point.distanceTolerance, point.headingTolerance};
}

template <class Skeleton, class Waypoint, class WaypointList>
bool PathService<Skeleton, Waypoint, WaypointList>::set(const WaypointList& path) {
  constexpr CORBA::ULong most = 10000;
  if (path.length() > most) return false;
  std::vector<Waypoint> points;
  for (CORBA::ULong i = 0; i < path.length(); ++i) {
    if (!std::ranges::all_of(numbers_of(path[i]), [](double value) { return std::isfinite(value); })) return false;
    points.push_back(path[i]);
  }
  state_.lock()->fresh = std::move(points);
  return true;
}

template <class Skeleton, class Waypoint, class WaypointList>
void PathService<Skeleton, Waypoint, WaypointList>::SetPath(const WaypointList& path) {
  if (!set(path)) throw CORBA::BAD_PARAM();
}

template <class Skeleton, class Waypoint, class WaypointList>
const Waypoint* PathService<Skeleton, Waypoint, WaypointList>::current(const State& state) {
  const auto& path = state.fresh ? *state.fresh : state.path;
  const std::size_t index = state.fresh ? 0 : state.index;
  return index < path.size() ? &path[index] : nullptr;
}

template <class Skeleton, class Waypoint, class WaypointList>
CORBA::UShort PathService<Skeleton, Waypoint, WaypointList>::GetCurrentWaypointIndex() {
  constexpr CORBA::UShort none = 65535;
  auto state = state_.lock();
  if (current(*state) == nullptr) return none;
  return state->fresh ? CORBA::UShort{0} : static_cast<CORBA::UShort>(state->index);
}

template <class Skeleton, class Waypoint, class WaypointList>
Waypoint PathService<Skeleton, Waypoint, WaypointList>::GetCurrentWaypoint() {
  {
    auto state = state_.lock();
    if (const auto* point = current(*state)) return *point;
  }
  throw CORBA::BAD_INV_ORDER();
}

template <class Skeleton, class Waypoint, class WaypointList>
bool PathService<Skeleton, Waypoint, WaypointList>::take_news() {
  auto state = state_.lock();
  if (!state->fresh) return false;
  state->path = std::move(*state->fresh);
  state->fresh.reset();
  state->index = 0;
  leave_leg();
  return true;
}

template <class Skeleton, class Waypoint, class WaypointList>
void PathService<Skeleton, Waypoint, WaypointList>::end() {
  auto state = state_.lock();
  state->path.clear();
  leave_leg();
}

template class PathService<POA_RTC::PathFollower2D, RTC::Waypoint2D, RTC::Waypoint2DList>;
template class PathService<POA_RTC::PathFollower3D, RTC::Waypoint3D, RTC::Waypoint3DList>;

PathFollower3d::Step PathFollower3d::next(const shm::Pose& odometry) {
  constexpr double near_enough = 0.1, straight_enough = 0.1;  // [m], [rad]
  auto state = state_.lock();
  for (; state->index < state->path.size(); ++state->index) {
    if (!state->is_enabled) return {std::nullopt, true};
    const RTC::Waypoint3D& point = state->path[state->index];
    const auto& [at, turn] = point.target;
    const double distance = std::hypot(at.x - odometry.x, at.y - odometry.y, at.z - odometry.z);
    const double off = std::abs(std::remainder(turn.y - shm::yaw_of(odometry), 2 * std::acos(-1.0)));
    if (distance > std::max(near_enough, point.distanceTolerance) || off > std::max(straight_enough, point.headingTolerance))
      return {Pose{at.x, at.y, at.z, turn.r, turn.p, turn.y}};
  }
  state->path.clear();
  return {};
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
