#include "waypoint_pilot.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

// clang-format off
static const char* const waypointpilot_spec[] = {
    "implementation_id", "WaypointPilot",
    "type_name", "WaypointPilot",
    "description", "Leads a vehicle from way point to way point",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "navigation",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "20",
    "exec_cxt.sim_time.phase", "1",
    "conf.default.waypoints", "0,0,2;2,0,2",
    "conf.default.speed", "1.0",
    "conf.default.turn_rate", "0.5",
    "conf.default.tolerance", "0.3",
    "conf.default.sideways", "1",
    "conf.__type__.waypoints", "string",
    "conf.__type__.speed", "double",
    "conf.__type__.turn_rate", "double",
    "conf.__type__.tolerance", "double",
    "conf.__type__.sideways", "int",
    "conf.__widget__.waypoints", "text",
    "conf.__widget__.speed", "text",
    "conf.__widget__.turn_rate", "text",
    "conf.__widget__.tolerance", "text",
    "conf.__widget__.sideways", "spin",
    "conf.__constraints__.sideways", "0<=x<=1",
    ""};
// clang-format on

namespace {

constexpr double closing = 0.7;  // [1/s]: speed for each metre that is left

double wrapped(double angle) { return std::remainder(angle, 2 * std::numbers::pi); }

}  // namespace

WaypointPilot::WaypointPilot(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      pose_in_("pose", pose_),
      velocity_out_("velocity", velocity_),
      reached_out_("reached", reached_) {}

RTC::ReturnCode_t WaypointPilot::onInitialize() {
  addInPort("pose", pose_in_);
  addOutPort("velocity", velocity_out_);
  addOutPort("reached", reached_out_);
  bindParameter("waypoints", waypoints_, "0,0,2;2,0,2");
  bindParameter("speed", speed_, "1.0");
  bindParameter("turn_rate", turn_rate_, "0.5");
  bindParameter("tolerance", tolerance_, "0.3");
  bindParameter("sideways", sideways_, "1");
  return RTC::RTC_OK;
}

std::vector<WaypointPilot::Place> WaypointPilot::places_of(const std::string& text) {
  std::vector<Place> places;
  std::istringstream all(text);
  for (std::string one; std::getline(all, one, ';');) {
    std::istringstream words(one);
    Place place{};
    char comma = 0, other = 0;
    if (!(words >> place[0] >> comma >> place[1] >> other >> place[2]) || comma != ',' || other != ',') return {};
    places.push_back(place);
  }
  return places;
}

RTC::ReturnCode_t WaypointPilot::onActivated(RTC::UniqueId) {
  places_ = places_of(waypoints_);
  if (places_.empty()) {
    RTC_ERROR(("waypoints must be x,y,z;x,y,z;..., got \"%s\"", waypoints_.c_str()));
    return RTC::RTC_ERROR;
  }
  next_ = 0;
  return RTC::RTC_OK;
}

RTC::ReturnCode_t WaypointPilot::onDeactivated(RTC::UniqueId) {
  send(0, 0, 0, 0);
  return RTC::RTC_OK;
}

RTC::ReturnCode_t WaypointPilot::onExecute(RTC::UniqueId) {
  bool is_new = false;
  while (pose_in_.isNew()) is_new = pose_in_.read() || is_new;
  if (!is_new) return RTC::RTC_OK;
  const auto& at = pose_.data.position;
  const Place& target = places_[std::min(next_, places_.size() - 1)];
  const Place way{target[0] - at.x, target[1] - at.y, target[2] - at.z};
  if (next_ < places_.size() && std::hypot(way[0], way[1], way[2]) < tolerance_) ++next_;
  steer(way);
  setTimestamp(reached_);
  reached_.data = static_cast<CORBA::Long>(next_);
  reached_out_.write();
  return RTC::RTC_OK;
}

void WaypointPilot::steer(const Place& way) {
  const double yaw = pose_.data.orientation.y, level = std::hypot(way[0], way[1]);
  const double turn = level > tolerance_ ? wrapped(std::atan2(way[1], way[0]) - yaw) : 0;
  const double yaw_rate = std::clamp(closing * 2 * turn, -turn_rate_, turn_rate_);
  const double climb = std::clamp(closing * way[2], -speed_, speed_);
  const double ahead = std::min(speed_, closing * level);
  if (sideways_ == 0) return send(level > tolerance_ ? ahead * std::max(std::cos(turn), 0.0) : 0, 0, climb, yaw_rate);
  const double bearing = std::atan2(way[1], way[0]) - yaw;
  send(ahead * std::cos(bearing), ahead * std::sin(bearing), climb, yaw_rate);
}

void WaypointPilot::send(double vx, double vy, double vz, double yaw_rate) {
  setTimestamp(velocity_);
  velocity_.data = {vx, vy, vz, 0, 0, yaw_rate};
  velocity_out_.write();
}

extern "C" {
void WaypointPilotInit(RTC::Manager* manager) {
  coil::Properties profile(waypointpilot_spec);
  manager->registerFactory(profile, RTC::Create<WaypointPilot>, RTC::Delete<WaypointPilot>);
}
}
