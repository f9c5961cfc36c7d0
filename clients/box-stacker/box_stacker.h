// BoxStacker: stacks boxes with an arm that has the JARA manipulator services. Consumer ports `common` and `middle`
// (JARA_ARM::ManipulatorCommonInterface_Common and _Middle, instances common and middle). OutPort `stacked` (RTC::TimedLong): boxes that it
// has put on the stack. Lengths [m] in the arm's frame, z = 0 where the boxes stand.
// Configuration: boxes: x,y of each box to pick, separated by semicolons; stack: x,y of the box that is the lowest of the stack; size: edge
// of a box; approach: height above a box where the arm begins to descend; tool: from the flange to the point between the fingers; speed:
// in % of the highest.
#pragma once

#include <rtm/ext/ManipulatorCommonInterface_CommonSkel.h>
#include <rtm/ext/ManipulatorCommonInterface_MiddleSkel.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/CorbaConsumer.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>

#include <string>
#include <vector>

class BoxStacker : public RTC::DataFlowComponentBase {
 public:
  explicit BoxStacker(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  struct Place {
    double x = 0, y = 0;
  };
  static std::vector<Place> places_of(const std::string& text);
  bool begin();
  bool stack(const Place& box, std::size_t level);
  bool go_above(const Place& place, double height);
  bool go_straight(const Place& place, double height);
  // Whether the arm accepted the call; its answer is released.
  bool is_ok(const char* call, JARA_ARM::RETURN_ID* answer);
  RTC::ReturnCode_t next();

  std::string boxes_, stack_;
  double size_ = 0, approach_ = 0, tool_ = 0;
  int speed_ = 0;

  RTC::TimedLong stacked_;
  RTC::OutPort<RTC::TimedLong> stacked_out_;
  RTC::CorbaPort common_port_, middle_port_;
  RTC::CorbaConsumer<JARA_ARM::ManipulatorCommonInterface_Common> common_;
  RTC::CorbaConsumer<JARA_ARM::ManipulatorCommonInterface_Middle> middle_;

  std::vector<Place> todo_;
  Place target_;
  std::size_t done_ = 0;
  bool has_begun_ = false, has_finished_ = false, is_waiting_ = false;
};

extern "C" {
DLL_EXPORT void BoxStackerInit(RTC::Manager* manager);
}
