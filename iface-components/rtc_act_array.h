// RTCActArray: the joints of an arm as an array of actuators of the RT Component interface guidelines. InPorts `position`, `speed` and
// `current` (RTC::ActArrayActuatorPos, -Speed, -Current) command one joint per sample, all samples of a tick count. OutPort `state`
// (RTC::ActArrayState): current is the effort [N m or N]. Service port `act_array` (RTC::ActArray). Configuration: server_id, device_id,
// joints.
#pragma once

#include <rtm/ext/ActArraySkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

#include "joint_component.h"

class RTCActArray;

// Calls from any thread. A call that means no joint is a line in the log.
class ActArrayService : public virtual POA_RTC::ActArray, public virtual PortableServer::RefCountServantBase {
 public:
  explicit ActArrayService(RTCActArray& owner) : owner_(owner) {}
  RTC::ActArrayGeometry* GetGeometry() override;
  void GoHome(CORBA::UShort index) override;
  void Power(CORBA::Boolean enable) override;
  void Brakes(CORBA::Boolean enable) override;
  void ConfigSpeed(CORBA::UShort index, CORBA::Double speed) override;
  void ConfigAccel(CORBA::UShort index, CORBA::Double accel) override;

 private:
  RTCActArray& owner_;
};

class RTCActArray : public iface::JointComponent {
 public:
  explicit RTCActArray(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

  // For the service, in the context's thread.
  void go_home(std::uint16_t index);
  void set_power(bool is_on);
  void set_brakes(bool are_on);
  void set_speed(std::uint16_t index, double speed);
  void set_acceleration(std::uint16_t index, double acceleration);

 protected:
  void read_ports() override;
  void publish(const shm::Stamp& stamp) override;

 private:
  // Calls `work` with the joint of the index, or with all of 65535; a line for others.
  void for_joint(std::uint16_t index, const std::function<base::Result<void>(std::size_t)>& work);
  bool may_move();
  void apply_brakes();

  bool is_powered_ = true, has_brakes_on_ = false;
  std::vector<double> last_speeds_;
  std::int64_t last_ns_ = 0;
  RTC::ActArrayActuatorPos position_;
  RTC::InPort<RTC::ActArrayActuatorPos> position_in_;
  RTC::ActArrayActuatorSpeed speed_;
  RTC::InPort<RTC::ActArrayActuatorSpeed> speed_in_;
  RTC::ActArrayActuatorCurrent current_;
  RTC::InPort<RTC::ActArrayActuatorCurrent> current_in_;
  RTC::ActArrayState state_;
  RTC::OutPort<RTC::ActArrayState> state_out_;
  RTC::CorbaPort service_port_;
  ActArrayService service_;
};

extern "C" {
DLL_EXPORT void RTCActArrayInit(RTC::Manager* manager);
}
