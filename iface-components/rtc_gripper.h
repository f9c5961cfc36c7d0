// RTCGripper: fingers as a gripper of the RT Component interface guidelines. OutPort `state` (RTC::GripperState): CLOSED also when the
// fingers hold something. Service port `gripper` (RTC::Gripper). Configuration: server_id, device_id; joints: the fingers; open, closed:
// their positions [m or rad], one number for all, empty: the upper and the lower limits; force: highest effort of each finger while it
// closes [N or N m], 0: that of the joint; speed: of the fingers, as a part of their highest.
#pragma once

#include <rtm/ext/GripperSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataOutPort.h>

#include "joint_component.h"

class RTCGripper;

// Calls from any thread.
class GripperService : public virtual POA_RTC::Gripper, public virtual PortableServer::RefCountServantBase {
 public:
  explicit GripperService(RTCGripper& owner) : owner_(owner) {}
  RTC::GripperGeometry GetGeometry() override;
  void Open() override;
  void Close() override;

 private:
  RTCGripper& owner_;
};

class RTCGripper : public iface::JointComponent {
 public:
  explicit RTCGripper(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

  // For the service, in the context's thread.
  void open();
  void close();
  // Any thread.
  RTC::GripperGeometry geometry() const;

 protected:
  void publish(const shm::Stamp& stamp) override;

 private:
  double open_position(std::size_t i) const;
  double closed_position(std::size_t i) const;
  RTC::GripperStatus status() const;

  std::string open_, closed_;
  double force_ = 0, speed_ = 0.5;
  RTC::GripperState state_;
  RTC::OutPort<RTC::GripperState> state_out_;
  RTC::CorbaPort service_port_;
  GripperService service_;
};

extern "C" {
DLL_EXPORT void RTCGripperInit(RTC::Manager* manager);
}
