// RTCPosition3d: drives a position3d iface by the InPort `velocity` (RTC::TimedVelocity3D), and bridges its state to the OutPorts
// `pose` (RTC::TimedPose3D) and `actual_velocity` (RTC::TimedVelocity3D). Service port
// `drive` (RTC::Odometry3D, RTC::VelocityControl3D). Configuration and threads: see drive_component.h.
#pragma once

#include <rtm/ext/OdometrySkel.h>
#include <rtm/ext/VelocityControlSkel.h>

#include <rtm/DataOutPort.h>

#include "drive_component.h"

class RTCPosition3d : public iface::DriveComponent<RTC::TimedVelocity3D> {
 public:
  explicit RTCPosition3d(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void describe(const shm::Iface& robot) override;
  void publish(const shm::Iface& robot) override;

 private:
  RTC::TimedPose3D pose_;
  RTC::OutPort<RTC::TimedPose3D> pose_out_;
  RTC::TimedVelocity3D actual_velocity_;
  RTC::OutPort<RTC::TimedVelocity3D> actual_velocity_out_;
  iface::OdometryService<POA_RTC::Odometry3D, RTC::Pose3D> odometry_service_;
  iface::GeometryService<POA_RTC::VelocityControl3D> velocity_service_;
};

extern "C" {
DLL_EXPORT void RTCPosition3dInit(RTC::Manager* manager);
}
