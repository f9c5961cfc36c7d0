#include "rtc_position3d.h"

#include "conversions.h"
#include "specification.h"

// clang-format off
static const char* const rtcposition3d_spec[] = {
    "implementation_id", "RTCPosition3d",
    "type_name", "RTCPosition3d",
    "description", "Flight or free movement of a simulated robot",
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
    "conf.default.device_id", "helicopter::position3d",
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

RTCPosition3d::RTCPosition3d(RTC::Manager* manager)
    : DriveComponent(manager, shm::IfaceType::position3d),
      pose_out_("pose", pose_),
      actual_velocity_out_("actual_velocity", actual_velocity_) {}

RTC::ReturnCode_t RTCPosition3d::onInitialize() {
  addVelocityPort();
  addOutPort("pose", pose_out_);
  addOutPort("actual_velocity", actual_velocity_out_);
  bindDrive("helicopter::position3d");
  return RTC::RTC_OK;
}

void RTCPosition3d::publish(const shm::Iface& robot) {
  const auto& sample = robot.sample<shm::Position3dSample>();
  pose_.tm = iface::to_time(sample.stamp.sim_time_ns);
  pose_.data = iface::to_pose(sample.odometry);
  pose_out_.write();
  const auto& v = sample.velocity;
  actual_velocity_.tm = pose_.tm;
  actual_velocity_.data = {v[0], v[1], v[2], v[3], v[4], v[5]};
  actual_velocity_out_.write();
}

extern "C" {
void RTCPosition3dInit(RTC::Manager* manager) {
  coil::Properties profile = iface::specification(rtcposition3d_spec);
  manager->registerFactory(profile, RTC::Create<RTCPosition3d>, RTC::Delete<RTCPosition3d>);
}
}
