// Porter: pushes the box in front of the robot straight ahead to a door, and drives back. It stops while its scan shows something in the
// lane. InPorts `odometry` (RTC::TimedPose2D), `range` (RTC::RangeData), OutPorts `velocity` (RTC::TimedVelocity2D), `stage`
// (RTC::TimedLong: 0 waiting, 1 bringing, 2 returning, 3 done). Configuration: the settings of delivery_rule.h; number and interval: it
// starts number * interval seconds after its activation, by the clock of the context.
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>

#include "delivery_rule.h"

class Porter : public RTC::DataFlowComponentBase {
 public:
  explicit Porter(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  void send(const warehouse::Velocity& velocity, const RTC::Time& time);

  warehouse::Settings settings_;
  double number_ = 0, interval_ = 0.5;

  RTC::TimedPose2D odometry_;
  RTC::InPort<RTC::TimedPose2D> odometry_in_;
  RTC::RangeData range_;
  RTC::InPort<RTC::RangeData> range_in_;
  RTC::TimedVelocity2D velocity_;
  RTC::OutPort<RTC::TimedVelocity2D> velocity_out_;
  RTC::TimedLong stage_;
  RTC::OutPort<RTC::TimedLong> stage_out_;

  warehouse::Stage now_ = warehouse::Stage::waiting;
  double start_ = 0;           // [s] of the activation
  bool has_scan_ = false;      // without one it does not drive
  bool has_odometry_ = false;  // likewise
};

extern "C" {
DLL_EXPORT void PorterInit(RTC::Manager* manager);
}
