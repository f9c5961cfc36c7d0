// RTCPosition2d: drives a position2d iface by the InPort `velocity` (RTC::TimedVelocity2D), and carries its state to the OutPorts
// `odometry` (RTC::TimedPose2D) and `actual_velocity` (RTC::TimedVelocity2D).
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

class RTCPosition2d : public iface::IfaceComponent {
 public:
  explicit RTCPosition2d(RTC::Manager* manager);
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

  RTC::TimedVelocity2D velocity_;
  RTC::InPort<RTC::TimedVelocity2D> velocity_in_;
  RTC::TimedPose2D odometry_;
  RTC::OutPort<RTC::TimedPose2D> odometry_out_;
  RTC::TimedVelocity2D actual_velocity_;
  RTC::OutPort<RTC::TimedVelocity2D> actual_velocity_out_;

  iface::Commander commander_;  // shared with the threads that bring velocities
  iface::CommandWatch watch_;
  bool motors_ = true;  // as told to the simulator
  iface::Errand errand_;
};

extern "C" {
DLL_EXPORT void RTCPosition2dInit(RTC::Manager* manager);
}
