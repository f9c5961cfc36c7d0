// WayPoints: leads a robot from pose to pose. InPort `odometry` (RTC::TimedPose2D), OutPort `goal` (RTC::TimedPose2D): the current
// goal, for a drive with pose control; OutPort `reached` (RTC::TimedLong): poses reached so far.
// Configuration: path: x,y,heading of each pose [m, rad] of the odometry, separated by semicolons; loop: begin again after the last;
// near, straight: when a pose is reached [m], [rad].
#pragma once

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>

#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>

#include <string>
#include <vector>

class WayPoints : public RTC::DataFlowComponentBase {
 public:
  explicit WayPoints(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  // Empty: the text is no path.
  static std::vector<RTC::Pose2D> poses_of(const std::string& text);
  bool is_at(const RTC::Pose2D& pose) const;
  void send_goal();

  std::string path_;
  int loop_ = 0;
  double near_ = 0, straight_ = 0;

  RTC::TimedPose2D odometry_;
  RTC::InPort<RTC::TimedPose2D> odometry_in_;
  RTC::TimedPose2D goal_;
  RTC::OutPort<RTC::TimedPose2D> goal_out_;
  RTC::TimedLong reached_;
  RTC::OutPort<RTC::TimedLong> reached_out_;

  std::vector<RTC::Pose2D> poses_;
  std::size_t next_ = 0;
  bool is_sent_ = false;
};

extern "C" {
DLL_EXPORT void WayPointsInit(RTC::Manager* manager);
}
