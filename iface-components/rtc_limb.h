// RTCLimb: a chain of joints as a limb of the RT Component interface guidelines. InPort `pose` (RTC::TimedPose3D): where the tip has to go,
// in the frame that carries the first joint; the newest counts, also on the way (poses can be streamed). OutPort `state` (RTC::LimbState):
// orientation (y axis), approach (z axis) and position of the tip [m]. Service port `limb` (RTC::Limb). Configuration: server_id,
// device_id; joints: from base to tip; tool: from the last joint to the tip, along its z axis [m]; speed: of the tip [m/s].
#pragma once

#include <arms/limb.h>
#include <rtm/ext/LimbSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

#include "joint_component.h"

class RTCLimb;

// Calls from any thread.
class LimbService : public virtual POA_RTC::Limb, public virtual PortableServer::RefCountServantBase {
 public:
  explicit LimbService(RTCLimb& owner) : owner_(owner) {}
  RTC::Geometry3D GetGeometry() override;
  void Power(CORBA::Boolean enable) override;
  void Brakes(CORBA::Boolean enable) override;
  void SetSpeed(CORBA::Double speed) override;

 private:
  RTCLimb& owner_;
};

class RTCLimb : public iface::JointComponent {
 public:
  explicit RTCLimb(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

  // For the service, in the context's thread.
  void set_power(bool is_on);
  void set_brakes(bool are_on);
  void set_speed(double speed);

 protected:
  void chosen() override;
  void read_ports() override;
  void step() override;
  void publish(const shm::Stamp& stamp) override;

 private:
  double tool_ = 0, speed_ = 0.25;
  arms::Limb limb_;
  std::string refusal_;  // of the last pose; logged once for each reason
  RTC::TimedPose3D pose_;
  RTC::InPort<RTC::TimedPose3D> pose_in_;
  RTC::LimbState state_;
  RTC::OutPort<RTC::LimbState> state_out_;
  RTC::CorbaPort service_port_;
  LimbService service_;
};

extern "C" {
DLL_EXPORT void RTCLimbInit(RTC::Manager* manager);
}
