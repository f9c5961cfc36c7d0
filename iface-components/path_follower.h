// RTC::PathFollower2D of the interface guidelines: which way point of a path comes next, and the velocity towards it. Services in any
// thread; the functions for the drive in its thread alone.
#pragma once

#include <rtm/ext/PathFollowerSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <base/guarded.h>
#include <shm/pose_control.h>

#include <optional>
#include <vector>

// Way points are poses of the odometry. One is reached within its tolerances [m, rad], or when pose control has arrived (1 cm, 0.01 rad).
// maxSpeed limits forward speed and turn rate, 0: as the drive likes. timeLimit is not looked at.
class PathFollower : public virtual POA_RTC::PathFollower2D, public virtual PortableServer::RefCountServantBase {
 public:
  // A path replaces the one before; an empty one ends it. Numbers that are not finite, or more than 10000 way points: CORBA::BAD_PARAM.
  void SetPath(const RTC::Waypoint2DList& path) override;
  // Without it the robot stands on its path.
  void Enable(CORBA::Boolean enable) override { state_.lock()->is_enabled = enable; }
  // 65535: there is none.
  CORBA::UShort GetCurrentWaypointIndex() override;
  // There is none: CORBA::BAD_INV_ORDER.
  RTC::Waypoint2D GetCurrentWaypoint() override;

  // False: SetPath would refuse it.
  bool set(const RTC::Waypoint2DList& path);
  // ---- for the drive ----
  // A path has been set since the last call.
  bool take_news();
  // Of the path, from the pose of the odometry; nothing: it has ended.
  std::optional<shm::PlanarPose> next(const shm::PlanarPose& odometry, const shm::Position2dInfo& robot);
  // Another command counts.
  void end();

 private:
  struct State {
    std::optional<std::vector<RTC::Waypoint2D>> fresh;
    std::vector<RTC::Waypoint2D> path;
    std::size_t index = 0;
    bool is_enabled = true;
  };
  static const RTC::Waypoint2D* current(const State& state);

  base::Guarded<State, base::Rank::details> state_;
  std::optional<shm::PoseControl> leg_;  // to the current way point
};
