#include "porter.h"

#include <span>

// clang-format off
static const char* const porter_spec[] = {
    "implementation_id", "Porter",
    "type_name", "Porter",
    "description", "Carries the object in front of a robot to a door, and returns",
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
    "conf.default.distance", "6",
    "conf.default.speed", "0.4",
    "conf.default.stop_distance", "1",
    "conf.default.lane_width", "0.5",
    "conf.default.number", "0",
    "conf.default.interval", "0.5",
    "conf.__type__.distance", "double",
    "conf.__type__.speed", "double",
    "conf.__type__.stop_distance", "double",
    "conf.__type__.lane_width", "double",
    "conf.__type__.number", "double",
    "conf.__type__.interval", "double",
    "conf.__widget__.distance", "text",
    "conf.__widget__.speed", "text",
    "conf.__widget__.stop_distance", "text",
    "conf.__widget__.lane_width", "text",
    "conf.__widget__.number", "text",
    "conf.__widget__.interval", "text",
    ""};
// clang-format on

namespace {

double seconds(const RTC::Time& time) { return time.sec + time.nsec * 1e-9; }

// Now, by the clock of the execution context.
RTC::Time time_of_context() {
  RTC::TimedLong stamp;
  setTimestamp(stamp);
  return stamp.tm;
}

}  // namespace

Porter::Porter(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      odometry_in_("odometry", odometry_),
      range_in_("range", range_),
      velocity_out_("velocity", velocity_),
      stage_out_("stage", stage_) {}

RTC::ReturnCode_t Porter::onInitialize() {
  addInPort("odometry", odometry_in_);
  addInPort("range", range_in_);
  addOutPort("velocity", velocity_out_);
  addOutPort("stage", stage_out_);
  bindParameter("distance", settings_.distance, "6");
  bindParameter("speed", settings_.speed, "0.4");
  bindParameter("stop_distance", settings_.stop_distance, "1");
  bindParameter("lane_width", settings_.lane_width, "0.5");
  bindParameter("number", number_, "0");
  bindParameter("interval", interval_, "0.5");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Porter::onActivated(RTC::UniqueId) {
  while (odometry_in_.isNew()) odometry_in_.read();
  while (range_in_.isNew()) range_in_.read();
  now_ = warehouse::Stage::waiting;
  start_ = seconds(time_of_context());
  has_scan_ = has_odometry_ = false;
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Porter::onDeactivated(RTC::UniqueId) {
  send({}, time_of_context());
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Porter::onExecute(RTC::UniqueId) {
  for (; odometry_in_.isNew(); has_odometry_ = true) odometry_in_.read();
  for (; range_in_.isNew(); has_scan_ = true) range_in_.read();
  const auto time = time_of_context();
  if (!has_odometry_ || !has_scan_) return RTC::RTC_OK;
  const warehouse::Place place{odometry_.data.position.x, odometry_.data.position.y, odometry_.data.heading};
  settings_.start_time = number_ * interval_;
  now_ = warehouse::next_stage(now_, place, seconds(time) - start_, settings_);
  const auto count = range_.ranges.length();
  const std::span<const double> ranges(count > 0 ? &range_.ranges[0] : nullptr, count);
  const bool is_stopped =
      now_ == warehouse::Stage::bringing && warehouse::is_blocked(ranges, range_.config.minAngle, range_.config.angularRes, settings_);
  send(is_stopped ? warehouse::Velocity{} : warehouse::drive(now_, place, settings_), time);
  stage_.tm = time;
  stage_.data = static_cast<CORBA::Long>(now_);
  stage_out_.write();
  return RTC::RTC_OK;
}

void Porter::send(const warehouse::Velocity& velocity, const RTC::Time& time) {
  velocity_.tm = time;
  velocity_.data.vx = velocity.forward;
  velocity_.data.vy = 0;
  velocity_.data.va = velocity.turn;
  velocity_out_.write();
}

extern "C" {
void PorterInit(RTC::Manager* manager) {
  coil::Properties profile(porter_spec);
  manager->registerFactory(profile, RTC::Create<Porter>, RTC::Delete<Porter>);
}
}
