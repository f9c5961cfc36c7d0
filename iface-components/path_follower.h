// RTC::PathFollower2D and 3D of the interface guidelines: selects the next way point of a path, and the command to reach it. Services in
// any thread; the functions for the drive in its thread alone.
#pragma once

#include <rtm/ext/PathFollowerSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <base/guarded.h>
#include <shm/pose_control.h>

#include <array>
#include <optional>
#include <vector>

// All numbers of a way point that count.
std::vector<double> numbers_of(const RTC::Waypoint2D& point);
std::vector<double> numbers_of(const RTC::Waypoint3D& point);

// The path, and where on it the drive is.
template <class Skeleton, class Waypoint, class WaypointList>
class PathService : public virtual Skeleton, public virtual PortableServer::RefCountServantBase {
 public:
  // A path replaces the one before; an empty one ends it. Numbers that are not finite, or more than 10000 way points: CORBA::BAD_PARAM.
  void SetPath(const WaypointList& path) override;
  // Without it the robot stands on its path.
  void Enable(CORBA::Boolean enable) override { state_.lock()->is_enabled = enable; }
  // 65535: there is none.
  CORBA::UShort GetCurrentWaypointIndex() override;
  // There is none: CORBA::BAD_INV_ORDER.
  Waypoint GetCurrentWaypoint() override;

  // False: SetPath would reject it.
  bool set(const WaypointList& path);
  // ---- for the drive ----
  // A path has been set since the last call.
  bool take_news();
  // Another command counts.
  void end();

 protected:
  struct State {
    std::optional<std::vector<Waypoint>> fresh;
    std::vector<Waypoint> path;
    std::size_t index = 0;
    bool is_enabled = true;
  };
  base::Guarded<State, base::Rank::details> state_;

 private:
  static const Waypoint* current(const State& state);
  virtual void leave_leg() {}
};

// Way points are poses of the odometry. One is reached within its tolerances [m, rad], or when pose control has arrived (1 cm, 0.01 rad).
// maxSpeed limits forward speed and turn rate, 0: as the drive likes. timeLimit is not looked at.
class PathFollower : public PathService<POA_RTC::PathFollower2D, RTC::Waypoint2D, RTC::Waypoint2DList> {
 public:
  // Of the path, from the pose of the odometry; nothing: it has ended.
  std::optional<shm::PlanarPose> next(const shm::PlanarPose& odometry, const shm::Position2dInfo& robot);

 private:
  void leave_leg() override { leg_.reset(); }
  std::optional<shm::PoseControl> leg_;  // to the current way point
};

// The same in space: the drive has pose control of its own. A way point is reached within its tolerances, at least 0.1 m and 0.1 rad of
// yaw. The robot stays at the last one. maxSpeed and timeLimit are not looked at.
class PathFollower3d : public PathService<POA_RTC::PathFollower3D, RTC::Waypoint3D, RTC::Waypoint3DList> {
 public:
  // The pose to command [m, rad]: x, y, z, roll, pitch, yaw; nothing: the path has ended, or waits for Enable (is_waiting).
  using Pose = std::array<double, 6>;
  struct Step {
    std::optional<Pose> pose;
    bool is_waiting = false;
  };
  Step next(const shm::Pose& odometry);
};
