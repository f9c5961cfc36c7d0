// RTCPosition2d: drives a position2d iface by the InPort `velocity` (RTC::TimedVelocity2D), and bridges its state to the OutPorts
// `odometry` (RTC::TimedPose2D) and `actual_velocity` (RTC::TimedVelocity2D). The InPort `pose_control` (RTC::TimedPose2D) takes a pose of
// the odometry to drive to, `heading_control` (RTC::TimedSpeedHeading2D) a speed and a heading to keep, `carlike_control`
// (RTC::TimedCarlike) the speed and the steering angle of a car, `path` (RTC::Path2D) way points to drive along; the newest command of the
// five counts. Service port `drive` (RTC::Odometry2D, RTC::VelocityControl2D, RTC::PoseControl2D, RTC::HeadingControl2D,
// RTC::CarlikeControl, RTC::PathFollower2D: path_follower.h). Configuration and threads: see drive_component.h.
#pragma once

#include <rtm/ext/CarlikeControlSkel.h>
#include <rtm/ext/HeadingControlSkel.h>
#include <rtm/ext/OdometrySkel.h>
#include <rtm/ext/PoseControlSkel.h>
#include <rtm/ext/VelocityControlSkel.h>

#include <rtm/DataOutPort.h>
#include <shm/pose_control.h>

#include <atomic>
#include <optional>
#include <variant>

#include "drive_component.h"
#include "path_follower.h"

class RTCPosition2d : public iface::DriveComponent<RTC::TimedVelocity2D> {
 public:
  explicit RTCPosition2d(RTC::Manager* manager);
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
    double speed = 0, angle = 0;  // [m/s], [rad]
  };
  struct Following {};  // what path_follower_ has
  void command(const shm::PlanarPose& velocity);
  void read_car();
  void read_path();
  // Of a goal that is no longer where it was. The robot stops.
  void give_up();
  void go_on(const shm::Position2dInfo& robot, const shm::Position2dSample& sample);

  std::variant<std::monostate, shm::PoseControl, Heading, Following> goal_;
  std::atomic<bool> was_odometry_set_{false};  // by a service, in any thread
  std::optional<std::uint32_t> resets_;        // of the world, when the goal was first pursued
  shm::Position2dInfo robot_{};
  RTC::TimedPose2D pose_;
  RTC::InPort<RTC::TimedPose2D> pose_in_;
  RTC::TimedSpeedHeading2D heading_;
  RTC::InPort<RTC::TimedSpeedHeading2D> heading_in_;
  RTC::TimedCarlike car_;
  RTC::InPort<RTC::TimedCarlike> car_in_;
  RTC::Path2D path_;
  RTC::InPort<RTC::Path2D> path_in_;
  RTC::TimedPose2D odometry_;
  RTC::OutPort<RTC::TimedPose2D> odometry_out_;
  RTC::TimedVelocity2D actual_velocity_;
  RTC::OutPort<RTC::TimedVelocity2D> actual_velocity_out_;
  iface::OdometryService<POA_RTC::Odometry2D, RTC::Pose2D> odometry_service_;
  iface::GeometryService<POA_RTC::VelocityControl2D, RTC::Geometry2D> velocity_service_;
  iface::GeometryService<POA_RTC::PoseControl2D, RTC::Geometry2D> pose_service_;
  iface::GeometryService<POA_RTC::HeadingControl2D, RTC::Geometry2D> heading_service_;
  iface::GeometryService<POA_RTC::CarlikeControl, RTC::Geometry2D> car_service_;
  PathFollower path_follower_;
};

extern "C" {
DLL_EXPORT void RTCPosition2dInit(RTC::Manager* manager);
}
