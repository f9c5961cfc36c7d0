// RTCPosition3d: drives a position3d iface by the InPort `velocity` (RTC::TimedVelocity3D), and carries its state to the OutPorts
// `pose` (RTC::TimedPose3D) and `actual_velocity` (RTC::TimedVelocity3D).
// Configuration: server_id, device_id, motors_enabled; command_timeout [s of simulated time]: the robot stops when no velocity has come
// for so long (0: never).
//
// Threads: in real time a velocity goes to the robot on the thread that brings it; in simulated time in onExecute, in the context's phase.
#pragma once

#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>

#include "commander.h"
#include "errand.h"
#include "iface_component.h"

class RTCPosition3d : public iface::IfaceComponent {
 public:
  explicit RTCPosition3d(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 protected:
  void attached(const iface::Device& device) override;
  void detaching() override;

 private:
  void publish();
  void switch_motors();

  bool motors_enabled_ = true;
  double command_timeout_ = 1;

  RTC::TimedVelocity3D velocity_;
  RTC::InPort<RTC::TimedVelocity3D> velocity_in_;
  RTC::TimedPose3D pose_;
  RTC::OutPort<RTC::TimedPose3D> pose_out_;
  RTC::TimedVelocity3D actual_velocity_;
  RTC::OutPort<RTC::TimedVelocity3D> actual_velocity_out_;

  iface::Commander commander_;  // shared with the threads that bring velocities
  iface::CommandWatch watch_;
  bool motors_ = true;  // as told to the simulator
  iface::Errand errand_;
};

extern "C" {
DLL_EXPORT void RTCPosition3dInit(RTC::Manager* manager);
}
