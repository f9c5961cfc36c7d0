// RTCRobotHardware: the joints of a robot with the ports of hrpsys' RobotHardware, so that controllers written for it connect without a
// change. InPorts `qRef`, `dqRef`, `tauRef` (RTC::TimedDoubleSeq, a value for each joint): positions with velocities and efforts that are
// fed forward; velocities, where no qRef has come; efforts, where neither has. OutPorts `q`, `dq`, `tau`, `ctau` (RTC::TimedDoubleSeq) and
// `servoState` (OpenHRP::TimedLongSeqSeq). Service port `RobotHardwareService` (OpenHRP::RobotHardwareService, instance service0).
// Configuration: server_id, device_id; joints: in the order of their ids, empty: that of the iface; servo: 1: on from the start. Read at
// creation only: sensors: NAME=KIND:IFACE, separated by commas, each an OutPort of that name: of kind rate (RTC::TimedAngularVelocity3D) or
// accel (RTC::TimedAcceleration3D) of an imu, or force (RTC::TimedDoubleSeq of 6) of a force and torque sensor.
#pragma once

#include <rtm/ext/HRPDataTypesSkel.h>
#include <rtm/ext/RobotHardwareServiceSkel.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "joint_component.h"

class RTCRobotHardware;

// Calls from any thread. What no simulated robot has, such as digital inputs, is answered with false and 0.
class RobotHardware : public virtual POA_OpenHRP::RobotHardwareService, public virtual PortableServer::RefCountServantBase {
 public:
  using Service = OpenHRP::RobotHardwareService;
  explicit RobotHardware(RTCRobotHardware& owner) : owner_(owner) {}
  void getStatus(Service::RobotState_out state) override;
  void getStatus2(Service::RobotState2_out state) override;
  CORBA::Boolean power(const char* name, Service::SwitchStatus status) override;
  CORBA::Boolean servo(const char* name, Service::SwitchStatus status) override;
  void setServoGainPercentage(const char* name, CORBA::Double percentage) override;
  void setServoErrorLimit(const char* name, CORBA::Double limit) override;
  void setJointControlMode(const char* name, Service::JointControlMode mode) override;
  void calibrateInertiaSensor() override {}
  void removeForceSensorOffset() override {}
  void initializeJointAngle(const char*, const char*) override {}
  CORBA::Boolean addJointGroup(const char* group, const Service::StrSequence& joints) override;
  CORBA::Boolean readDigitalInput(Service::OctSequence_out bits) override;
  CORBA::Long lengthDigitalInput() override { return 0; }
  CORBA::Boolean writeDigitalOutput(const Service::OctSequence&) override { return false; }
  CORBA::Boolean writeDigitalOutputWithMask(const Service::OctSequence&, const Service::OctSequence&) override { return false; }
  CORBA::Long lengthDigitalOutput() override { return 0; }
  CORBA::Boolean readDigitalOutput(Service::OctSequence_out bits) override;

 private:
  RTCRobotHardware& owner_;
};

class RTCRobotHardware : public iface::JointComponent {
 public:
  explicit RTCRobotHardware(RTC::Manager* manager);
  ~RTCRobotHardware() override;
  RTC::ReturnCode_t onInitialize() override;

  // Any thread.
  struct Status {
    std::vector<double> position, command, effort;
    std::vector<std::int32_t> servo;
    std::vector<std::vector<double>> force, rate, acceleration;  // of the sensors, in the order of the parameter
  };
  Status status() const { return *status_.lock(); }
  // Numbers of the joints that a joint's name, a group or "all" means; empty: there is none.
  std::vector<std::size_t> joints_named(const std::string& name) const;
  bool add_group(const std::string& name, const std::vector<std::string>& joints);

  // In the context's thread.
  void set_servo(const std::vector<std::size_t>& joints, bool is_on);
  void set_power(const std::vector<std::size_t>& joints, bool is_on);
  void set_error_limit(const std::vector<std::size_t>& joints, double limit);
  void set_gain(const std::vector<std::size_t>& joints, double percent);
  using ControlMode = OpenHRP::RobotHardwareService::JointControlMode;
  void set_mode(const std::vector<std::size_t>& joints, ControlMode mode);

 protected:
  void attached(const iface::Device& device) override;
  void detaching() override;
  void read_ports() override;
  void step() override;
  void publish(const shm::Stamp& stamp) override;

 private:
  struct Reference {
    const char* name;
    RTC::TimedDoubleSeq& data;
    RTC::InPort<RTC::TimedDoubleSeq>& port;
    bool has_come = false, was_right = true;
  };
  struct Servo {
    bool is_on = true, is_powered = true;
    double error_limit = 0;             // [rad or m]; 0: none
    std::optional<ControlMode> mode{};  // nothing: by what comes
    bool is_active() const { return is_on && is_powered; }
  };
  // A sensor of the robot on a port of its own.
  struct Sensor;
  void add_sensors();
  void read_sensors(Status& now);
  bool read(Reference& reference);
  void command(std::size_t i, bool has_q, bool has_dq, bool has_tau);
  double value(const Reference& reference, std::size_t i) const;
  // Of two limits the nearest counts, as a motor saturates; nothing when the value is no number. One line for either.
  std::optional<double> limited(const Reference& reference, std::size_t i, double low, double high);
  void fit();
  void apply(std::size_t i);

  int servo_ = 1;
  std::vector<std::unique_ptr<Sensor>> sensors_;
  RTC::TimedDoubleSeq q_ref_, dq_ref_, tau_ref_, q_, dq_, tau_, ctau_;
  RTC::InPort<RTC::TimedDoubleSeq> q_ref_in_;
  RTC::InPort<RTC::TimedDoubleSeq> dq_ref_in_;
  RTC::InPort<RTC::TimedDoubleSeq> tau_ref_in_;
  Reference positions_{"qRef", q_ref_, q_ref_in_}, velocities_{"dqRef", dq_ref_, dq_ref_in_}, efforts_{"tauRef", tau_ref_, tau_ref_in_};
  RTC::OutPort<RTC::TimedDoubleSeq> q_out_;
  RTC::OutPort<RTC::TimedDoubleSeq> dq_out_;
  RTC::OutPort<RTC::TimedDoubleSeq> tau_out_;
  RTC::OutPort<RTC::TimedDoubleSeq> ctau_out_;
  OpenHRP::TimedLongSeqSeq servo_state_;
  RTC::OutPort<OpenHRP::TimedLongSeqSeq> servo_state_out_;
  RTC::CorbaPort service_port_;
  RobotHardware service_;
  std::vector<Servo> servos_;
  base::Guarded<Status, base::Rank::details> status_;
  base::Guarded<std::map<std::string, std::vector<std::string>>, base::Rank::details> groups_;
};

extern "C" {
DLL_EXPORT void RTCRobotHardwareInit(RTC::Manager* manager);
}
