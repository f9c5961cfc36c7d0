// RTCPTZ: two joints as a pan and tilt unit of the RT Component interface guidelines. InPort `angles` (RTC::PanTiltAngles) turns both
// [rad]. OutPort `state` (RTC::PanTiltState). Service port `pan_tilt` (RTC::PanTilt). Configuration: server_id, device_id; joints: pan and
// tilt, in this order; speed: a part of their highest. Zoom has no structure in the guidelines.
#pragma once

#include <rtm/ext/PanTiltSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

#include "joint_component.h"

class RTCPTZ;

// Calls from any thread.
class PanTiltService : public virtual POA_RTC::PanTilt, public virtual PortableServer::RefCountServantBase {
 public:
  explicit PanTiltService(RTCPTZ& owner) : owner_(owner) {}
  RTC::Geometry3D GetGeometry() override;

 private:
  RTCPTZ& owner_;
};

class RTCPTZ : public iface::JointComponent {
 public:
  explicit RTCPTZ(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void read_ports() override;
  void publish(const shm::Stamp& stamp) override;

 private:
  bool has_both();

  double speed_ = 1;
  bool was_complete_ = true;
  RTC::PanTiltAngles angles_;
  RTC::InPort<RTC::PanTiltAngles> angles_in_;
  RTC::PanTiltState state_;
  RTC::OutPort<RTC::PanTiltState> state_out_;
  RTC::CorbaPort service_port_;
  PanTiltService service_;
};

extern "C" {
DLL_EXPORT void RTCPTZInit(RTC::Manager* manager);
}
