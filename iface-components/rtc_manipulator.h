// RTCManipulator: an arm and its gripper with the common manipulator interface of JARA. Service ports `common` and `middle`
// (ManipulatorCommonInterface_Common, _Middle). InPort `command` (JARA_ARM::TimedJointPos): low-level positions, one sample is read every
// `cycle`. InPort `emergency` (RTC::TimedBoolean): true stops the arm by its brakes until false has come. OutPort `joints`
// (JARA_ARM::TimedJointPos): positions, then the gripper's ratio in %. Configuration: server_id, device_id; joints: of the arm, from base
// to tip; gripper: joints of the fingers, empty: none; force: highest effort of each finger while it closes [N or N m], 0: that of the
// joint; speed: in % of the highest until a client sets one; units: si (rad, m) or deg_mm; cycle: of low-level commands [ms]. Read at
// creation only: common, middle: instance names of the interfaces; module: JARA_ARM or none, part of their type names.
#pragma once

#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>

#include <string>

#include "joint_component.h"
#include "manipulator_services.h"

class RTCManipulator : public iface::JointComponent, public iface::ManipulatorOwner {
 public:
  explicit RTCManipulator(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

  arms::Reply call(const Work& work) override;
  arms::Reply move(const Planned& plan) override;

 protected:
  std::string all_names(const std::string& joints) const override;
  void chosen() override;
  void detaching() override;
  void read_ports() override;
  void step() override;
  void publish(const shm::Stamp& stamp) override;

 private:
  struct Shared {
    bool is_there = false;
    arms::Manipulator arm;
    iface::ClientUnits units;
  };
  void addServices();
  arms::Manipulator::Feedback feedback() const;
  double finger_ratio() const;
  void command_fingers(const arms::FingerCommand& command);
  void log_alarms(const std::vector<arms::Manipulator::Alarm>& alarms);

  std::string gripper_, units_ = "si";
  double force_ = 0;
  std::size_t axes_ = 0;  // the first ones of part(); then the fingers
  int speed_ = 50, cycle_ = 1;
  bool was_servo_on_ = true;  // the first tick without a servo puts the brakes on
  std::size_t logged_alarms_ = 0;
  bool was_command_right_ = true;
  std::int64_t command_wait_ns_ = 0;  // until the next low-level sample is read
  // Clients call from any thread. The turn is for planning, which takes long; data is locked only to copy it and to queue the result.
  base::Turn<> planning_turn_;
  base::Guarded<Shared, base::Rank::details> shared_;
  JARA_ARM::TimedJointPos command_;
  RTC::InPort<JARA_ARM::TimedJointPos> command_in_;
  RTC::TimedBoolean emergency_;
  RTC::InPort<RTC::TimedBoolean> emergency_in_;
  JARA_ARM::TimedJointPos joints_;
  RTC::OutPort<JARA_ARM::TimedJointPos> joints_out_;
  RTC::CorbaPort common_port_, middle_port_;
  iface::ManipulatorCommon common_service_;
  iface::ManipulatorMiddle middle_service_;
};

extern "C" {
DLL_EXPORT void RTCManipulatorInit(RTC::Manager* manager);
}
