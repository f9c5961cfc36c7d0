// LaserObstacleAvoid: drives a robot around obstacles. InPort `range` (RTC::RangeData), OutPort `velocity` (RTC::TimedVelocity2D).
// Configuration: the settings of avoidance.h; scan_timeout [s of the context's time]: the robot is stopped if no scan has arrived for this
// time.
#pragma once

#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>

#include "avoidance.h"

class LaserObstacleAvoid : public RTC::DataFlowComponentBase {
 public:
  explicit LaserObstacleAvoid(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onAborting(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  void drive(const avoidance::Velocity& velocity, const RTC::Time& time);
  void stop(const char* why);

  avoidance::Settings settings_;
  double scan_timeout_ = 1;

  RTC::RangeData range_;
  RTC::InPort<RTC::RangeData> range_in_;
  RTC::TimedVelocity2D velocity_;
  RTC::OutPort<RTC::TimedVelocity2D> velocity_out_;

  double last_scan_ = 0;  // [s] when it was read
  bool is_driving_ = false;
};

extern "C" {
DLL_EXPORT void LaserObstacleAvoidInit(RTC::Manager* manager);
}
