// WaypointPilot: leads a vehicle with RTCPosition3d from way point to way point. InPort `pose` (RTC::TimedPose3D): the pose of the vehicle.
// OutPorts `velocity` (RTC::TimedVelocity3D): its command, in the frame of the vehicle; `reached` (RTC::TimedLong): way points that it has
// reached. After the last one it stays there. Configuration: waypoints: x,y,z [m] of each, in the frame of the pose, separated by
// semicolons; speed [m/s], turn_rate [rad/s]: highest; tolerance [m]: how near counts as reached; sideways: 1: the vehicle can move to all
// sides (multicopter), 0: it turns to the way point and drives forward (boat).
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>

#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>

#include <array>
#include <string>
#include <vector>

class WaypointPilot : public RTC::DataFlowComponentBase {
 public:
  explicit WaypointPilot(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  using Place = std::array<double, 3>;
  static std::vector<Place> places_of(const std::string& text);
  void steer(const Place& way);
  void send(double vx, double vy, double vz, double yaw_rate);

  RTC::TimedPose3D pose_;
  RTC::InPort<RTC::TimedPose3D> pose_in_;
  RTC::TimedVelocity3D velocity_;
  RTC::OutPort<RTC::TimedVelocity3D> velocity_out_;
  RTC::TimedLong reached_;
  RTC::OutPort<RTC::TimedLong> reached_out_;
  std::string waypoints_;
  double speed_ = 1, turn_rate_ = 0.5, tolerance_ = 0.3;
  int sideways_ = 1;
  std::vector<Place> places_;
  std::size_t next_ = 0;
};

extern "C" {
DLL_EXPORT void WaypointPilotInit(RTC::Manager* manager);
}
