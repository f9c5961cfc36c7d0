#include "way_points.h"

#include <cmath>
#include <sstream>

// clang-format off
static const char* const waypoints_spec[] = {
    "implementation_id", "WayPoints",
    "type_name", "WayPoints",
    "description", "Leads a robot from pose to pose",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "navigation",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "10",
    "exec_cxt.sim_time.phase", "1",
    "conf.default.path", "1,0,0;0,0,0",
    "conf.default.loop", "0",
    "conf.default.near", "0.02",
    "conf.default.straight", "0.02",
    "conf.__type__.path", "string",
    "conf.__type__.loop", "int",
    "conf.__type__.near", "double",
    "conf.__type__.straight", "double",
    "conf.__widget__.path", "text",
    "conf.__widget__.loop", "radio",
    "conf.__widget__.near", "text",
    "conf.__widget__.straight", "text",
    "conf.__constraints__.loop", "(0,1)",
    "conf.__constraints__.near", "x>0",
    "conf.__constraints__.straight", "x>0",
    ""};
// clang-format on

WayPoints::WayPoints(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      odometry_in_("odometry", odometry_),
      goal_out_("goal", goal_),
      reached_out_("reached", reached_) {}

RTC::ReturnCode_t WayPoints::onInitialize() {
  addInPort("odometry", odometry_in_);
  addOutPort("goal", goal_out_);
  addOutPort("reached", reached_out_);
  bindParameter("path", path_, "1,0,0;0,0,0");
  bindParameter("loop", loop_, "0");
  bindParameter("near", near_, "0.02");
  bindParameter("straight", straight_, "0.02");
  return RTC::RTC_OK;
}

std::vector<RTC::Pose2D> WayPoints::poses_of(const std::string& text) {
  std::vector<RTC::Pose2D> poses;
  std::istringstream all(text);
  for (std::string one; std::getline(all, one, ';');) {
    std::istringstream words(one);
    RTC::Pose2D pose{};
    char first = 0, second = 0;
    if (!(words >> pose.position.x >> first >> pose.position.y >> second >> pose.heading) || first != ',' || second != ',') return {};
    poses.push_back(pose);
  }
  return poses;
}

RTC::ReturnCode_t WayPoints::onActivated(RTC::UniqueId) {
  poses_ = poses_of(path_);
  next_ = 0;
  is_sent_ = false;
  reached_.data = 0;
  while (odometry_in_.isNew()) odometry_in_.read();
  if (!poses_.empty()) return RTC::RTC_OK;
  RTC_ERROR(("path: expected x,y,heading of each pose, separated by semicolons, got \"%s\"", path_.c_str()));
  return RTC::RTC_ERROR;
}

bool WayPoints::is_at(const RTC::Pose2D& pose) const {
  const auto& now = odometry_.data;
  const double away = std::hypot(pose.position.x - now.position.x, pose.position.y - now.position.y);
  return away < near_ && std::abs(std::remainder(pose.heading - now.heading, 2 * std::acos(-1.0))) < straight_;
}

void WayPoints::send_goal() {
  goal_.tm = odometry_.tm;
  goal_.data = poses_[next_];
  goal_out_.write();
  is_sent_ = true;
}

RTC::ReturnCode_t WayPoints::onExecute(RTC::UniqueId) {
  bool is_new = false;
  while (odometry_in_.isNew()) is_new = odometry_in_.read() || is_new;
  if (!is_new || next_ >= poses_.size()) return RTC::RTC_OK;
  if (!is_sent_) {
    send_goal();
  } else if (is_at(poses_[next_])) {
    reached_.tm = odometry_.tm;
    ++reached_.data;
    reached_out_.write();
    ++next_;
    if (next_ == poses_.size() && loop_ != 0) next_ = 0;
    if (next_ < poses_.size()) send_goal();
  }
  return RTC::RTC_OK;
}

extern "C" {
void WayPointsInit(RTC::Manager* manager) {
  coil::Properties profile(waypoints_spec);
  manager->registerFactory(profile, RTC::Create<WayPoints>, RTC::Delete<WayPoints>);
}
}
