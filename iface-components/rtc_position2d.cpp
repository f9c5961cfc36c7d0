#include "rtc_position2d.h"

#include "conversions.h"
#include "specification.h"

// clang-format off
static const char* const rtcposition2d_spec[] = {
    "implementation_id", "RTCPosition2d",
    "type_name", "RTCPosition2d",
    "description", "Drive of a simulated robot",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "simulation",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "1000",
    "exec_cxt.sim_time.phase", "2",
    "conf.default.server_id", "0",
    "conf.default.device_id", "pioneer2dx::position2d",
    "conf.default.motors_enabled", "1",
    "conf.default.command_timeout", "1.0",
    "conf.__type__.server_id", "int",
    "conf.__type__.device_id", "string",
    "conf.__type__.motors_enabled", "int",
    "conf.__type__.command_timeout", "double",
    "conf.__widget__.server_id", "spin",
    "conf.__widget__.device_id", "text",
    "conf.__widget__.motors_enabled", "radio",
    "conf.__widget__.command_timeout", "text",
    "conf.__constraints__.server_id", "0<=x<=9999",
    "conf.__constraints__.motors_enabled", "(0,1)",
    "conf.__constraints__.command_timeout", "x>=0",
    ""};
// clang-format on

RTCPosition2d::RTCPosition2d(RTC::Manager* manager)
    : DriveComponent(manager, shm::IfaceType::position2d),
      odometry_out_("odometry", odometry_),
      actual_velocity_out_("actual_velocity", actual_velocity_) {}

RTC::ReturnCode_t RTCPosition2d::onInitialize() {
  addVelocityPort();
  addOutPort("odometry", odometry_out_);
  addOutPort("actual_velocity", actual_velocity_out_);
  bindDrive("pioneer2dx::position2d");
  return RTC::RTC_OK;
}

void RTCPosition2d::publish(const shm::Iface& robot) {
  const auto& sample = robot.sample<shm::Position2dSample>();
  odometry_.tm = iface::to_time(sample.stamp.sim_time_ns);
  odometry_.data.position.x = sample.odometry[0];
  odometry_.data.position.y = sample.odometry[1];
  odometry_.data.heading = sample.odometry[2];
  odometry_out_.write();
  actual_velocity_.tm = odometry_.tm;
  actual_velocity_.data.vx = sample.velocity[0];
  actual_velocity_.data.vy = sample.velocity[1];
  actual_velocity_.data.va = sample.velocity[2];
  actual_velocity_out_.write();
}

extern "C" {
void RTCPosition2dInit(RTC::Manager* manager) {
  coil::Properties profile = iface::specification(rtcposition2d_spec);
  manager->registerFactory(profile, RTC::Create<RTCPosition2d>, RTC::Delete<RTCPosition2d>);
}
}
