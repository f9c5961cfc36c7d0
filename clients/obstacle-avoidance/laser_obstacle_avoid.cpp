#include "laser_obstacle_avoid.h"

#include <vector>

// clang-format off
static const char* const laserobstacleavoid_spec[] = {
    "implementation_id", "LaserObstacleAvoid",
    "type_name", "LaserObstacleAvoid",
    "description", "Drives where there is room, by a laser scan",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "navigation",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "1000",
    "exec_cxt.sim_time.phase", "1",
    "conf.default.distance_gain", "200",
    "conf.default.stop_distance", "0.5",
    "conf.default.clearance_cap", "100",
    "conf.default.speed_gain", "0.001",
    "conf.default.turn_gain", "1",
    "conf.default.max_turn", "40",
    "conf.default.scan_timeout", "1",
    "conf.__type__.distance_gain", "double",
    "conf.__type__.stop_distance", "double",
    "conf.__type__.clearance_cap", "double",
    "conf.__type__.speed_gain", "double",
    "conf.__type__.turn_gain", "double",
    "conf.__type__.max_turn", "double",
    "conf.__type__.scan_timeout", "double",
    "conf.__widget__.distance_gain", "text",
    "conf.__widget__.stop_distance", "text",
    "conf.__widget__.clearance_cap", "text",
    "conf.__widget__.speed_gain", "text",
    "conf.__widget__.turn_gain", "text",
    "conf.__widget__.max_turn", "text",
    "conf.__widget__.scan_timeout", "text",
    ""};
// clang-format on

namespace {

// How long onExecute waits for a scan in real time [s], so that a scan is answered when it comes and not when the context looks.
constexpr double longest_wait = 0.05;

// Now [s], by the clock of the execution context.
double now() {
  RTC::TimedLong stamp;
  setTimestamp(stamp);
  return stamp.tm.sec + stamp.tm.nsec * 1e-9;
}

}  // namespace

LaserObstacleAvoid::LaserObstacleAvoid(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager), range_in_("range", range_), velocity_out_("velocity", velocity_) {}

RTC::ReturnCode_t LaserObstacleAvoid::onInitialize() {
  addInPort("range", range_in_);
  addOutPort("velocity", velocity_out_);
  bindParameter("distance_gain", settings_.distance_gain, "200");
  bindParameter("stop_distance", settings_.stop_distance, "0.5");
  bindParameter("clearance_cap", settings_.clearance_cap, "100");
  bindParameter("speed_gain", settings_.speed_gain, "0.001");
  bindParameter("turn_gain", settings_.turn_gain, "1");
  bindParameter("max_turn", settings_.max_turn, "40");
  bindParameter("scan_timeout", scan_timeout_, "1");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t LaserObstacleAvoid::onActivated(RTC::UniqueId) {
  while (range_in_.isNew()) range_in_.read();  // scans from before would be answered too late
  last_scan_ = now();
  is_driving_ = false;
  return RTC::RTC_OK;
}

RTC::ReturnCode_t LaserObstacleAvoid::onDeactivated(RTC::UniqueId) {
  stop("");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t LaserObstacleAvoid::onAborting(RTC::UniqueId) {
  stop("");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t LaserObstacleAvoid::onExecute(RTC::UniqueId) {
  const bool is_new = range_in_.waitNew(longest_wait);
  const double time = now();
  if (!is_new) {
    // A clock that ran backwards is that of a world that was reset.
    if (time < last_scan_) last_scan_ = time;
    if (scan_timeout_ > 0 && time - last_scan_ > scan_timeout_) stop("no scan arrives any more");
    return RTC::RTC_OK;
  }
  while (range_in_.isNew()) range_in_.read();  // the newest counts
  last_scan_ = time;
  const auto count = range_.ranges.length();
  const std::span<const double> ranges(count > 0 ? &range_.ranges[0] : nullptr, count);
  drive(avoidance::avoid(ranges, range_.config.maxRange, settings_), range_.tm);
  return RTC::RTC_OK;
}

void LaserObstacleAvoid::drive(const avoidance::Velocity& velocity, const RTC::Time& time) {
  velocity_.tm = time;
  velocity_.data.vx = velocity.forward;
  velocity_.data.vy = 0;
  velocity_.data.va = velocity.turn;
  is_driving_ = true;
  velocity_out_.write();
}

void LaserObstacleAvoid::stop(const char* why) {
  if (!is_driving_) return;
  if (*why != '\0') RTC_WARN(("%s: stopping", why));
  drive({}, velocity_.tm);
  is_driving_ = false;
}

extern "C" {
void LaserObstacleAvoidInit(RTC::Manager* manager) {
  coil::Properties profile(laserobstacleavoid_spec);
  manager->registerFactory(profile, RTC::Create<LaserObstacleAvoid>, RTC::Delete<LaserObstacleAvoid>);
}
}
