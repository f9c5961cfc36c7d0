// RTCPosition3d: drives a position3d iface by the InPort `velocity` (RTC::TimedVelocity3D), and bridges its state to the OutPorts
// `pose` (RTC::TimedPose3D) and `actual_velocity` (RTC::TimedVelocity3D). The InPort `pose_control` (RTC::TimedPose3D) takes a pose of the
// odometry to move to and to stay at, `heading_control` (RTC::TimedSpeedHeading3D) a speed and a direction to keep, `path` (RTC::Path3D)
// way points to move along; the newest command of the four counts. Service port `drive` (RTC::Odometry3D, RTC::VelocityControl3D,
// RTC::PoseControl3D, RTC::HeadingControl3D, RTC::PathFollower3D: path_follower.h).
// Configuration and threads: see drive_component.h.
#pragma once

#include <rtm/ext/HeadingControlSkel.h>
#include <rtm/ext/OdometrySkel.h>
#include <rtm/ext/PoseControlSkel.h>
#include <rtm/ext/VelocityControlSkel.h>

#include <rtm/DataOutPort.h>

#include <array>
#include <atomic>
#include <optional>
#include <variant>

#include "drive_component.h"
#include "path_follower.h"

class RTCPosition3d : public iface::DriveComponent<RTC::TimedVelocity3D> {
 public:
  explicit RTCPosition3d(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void describe(const shm::Iface& robot) override;
  void publish(const shm::Iface& robot) override;
  void velocity_came() override { goal_ = {}; }
  void timed_out() override { goal_ = {}; }
  void read_goals() override;
  void detaching() override;

 private:
  struct Heading {
    double speed = 0, pitch = 0, yaw = 0;  // [m/s], [rad]
  };
  using Goal = std::array<double, 6>;  // pose: x, y, z, roll, pitch, yaw
  struct Following {};                 // what path_follower_ has
  void read_path();
  void follow(const shm::Position3dSample& sample);
  void command(const std::array<double, 6>& values, shm::CommandKind kind);
  void go_on(const shm::Position3dSample& sample);

  std::variant<std::monostate, Goal, Heading, Following> goal_;
  std::atomic<bool> was_odometry_set_{false};  // by a service, in any thread
  std::optional<std::uint32_t> resets_;        // of the world, when the goal was first pursued
  RTC::TimedPose3D wanted_pose_;
  RTC::InPort<RTC::TimedPose3D> pose_in_;
  RTC::TimedSpeedHeading3D heading_;
  RTC::InPort<RTC::TimedSpeedHeading3D> heading_in_;
  RTC::Path3D path_;
  RTC::InPort<RTC::Path3D> path_in_;
  RTC::TimedPose3D pose_;
  RTC::OutPort<RTC::TimedPose3D> pose_out_;
  RTC::TimedVelocity3D actual_velocity_;
  RTC::OutPort<RTC::TimedVelocity3D> actual_velocity_out_;
  iface::OdometryService<POA_RTC::Odometry3D, RTC::Pose3D> odometry_service_;
  iface::GeometryService<POA_RTC::VelocityControl3D> velocity_service_;
  iface::GeometryService<POA_RTC::PoseControl3D> pose_service_;
  iface::GeometryService<POA_RTC::HeadingControl3D> heading_service_;
  PathFollower3d path_follower_;
  std::optional<Goal> last_;  // way point of the path that was commanded
};

extern "C" {
DLL_EXPORT void RTCPosition3dInit(RTC::Manager* manager);
}
