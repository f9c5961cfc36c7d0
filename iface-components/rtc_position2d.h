// RTCPosition2d: drives a position2d iface by the InPort `velocity` (RTC::TimedVelocity2D), and bridges its state to the OutPorts
// `odometry` (RTC::TimedPose2D) and `actual_velocity` (RTC::TimedVelocity2D). Service port
// `drive` (RTC::Odometry2D, RTC::VelocityControl2D). Configuration and threads: see drive_component.h.
#pragma once

#include <rtm/ext/OdometrySkel.h>
#include <rtm/ext/VelocityControlSkel.h>

#include <rtm/DataOutPort.h>

#include "drive_component.h"

class RTCPosition2d : public iface::DriveComponent<RTC::TimedVelocity2D> {
 public:
  explicit RTCPosition2d(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void describe(const shm::Iface& robot) override;
  void publish(const shm::Iface& robot) override;

 private:
  RTC::TimedPose2D odometry_;
  RTC::OutPort<RTC::TimedPose2D> odometry_out_;
  RTC::TimedVelocity2D actual_velocity_;
  RTC::OutPort<RTC::TimedVelocity2D> actual_velocity_out_;
  iface::OdometryService<POA_RTC::Odometry2D, RTC::Pose2D> odometry_service_;
  iface::GeometryService<POA_RTC::VelocityControl2D, RTC::Geometry2D> velocity_service_;
};

extern "C" {
DLL_EXPORT void RTCPosition2dInit(RTC::Manager* manager);
}
