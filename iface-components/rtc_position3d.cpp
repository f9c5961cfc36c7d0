#include "rtc_position3d.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCPosition3d",
    .description = "Flight or free movement of a simulated robot",
    .phase = iface::command_phase,
    .device = "helicopter::position3d",
    .parameters = iface::drive_parameters(),
};

RTCPosition3d::RTCPosition3d(RTC::Manager* manager)
    : DriveComponent(manager, specification, shm::IfaceType::position3d),
      pose_out_("pose", pose_),
      actual_velocity_out_("actual_velocity", actual_velocity_) {}

RTC::ReturnCode_t RTCPosition3d::onInitialize() {
  addVelocityPort();
  addOutPort("pose", pose_out_);
  addOutPort("actual_velocity", actual_velocity_out_);
  bindDrive();
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
void RTCPosition3dInit(RTC::Manager* manager) { iface::register_type<RTCPosition3d>(manager, specification); }
}
