#include "rtc_ptz.h"

#include <utility>

#include "conversions.h"

static const iface::Specification specification{
    .type_name = "RTCPTZ",
    .description = "Pan and tilt joints of a simulated camera",
    .phase = iface::command_phase,
    .device = "eye::joints",
    .parameters = {{"joints", "pan,tilt", "string", "text"}, {"speed", "1", "double", "text", "0<x<=1"}},
};

RTC::Geometry3D PanTiltService::GetGeometry() {
  RTC::Geometry3D geometry{};
  const auto joints = owner_.described();
  if (!joints.empty()) geometry.pose = iface::to_pose(joints.front().pose);
  return geometry;
}

RTCPTZ::RTCPTZ(RTC::Manager* manager)
    : JointComponent(manager, specification),
      angles_in_("angles", angles_),
      state_out_("state", state_),
      service_port_("pan_tilt"),
      service_(*this) {}

RTC::ReturnCode_t RTCPTZ::onInitialize() {
  addInPort("angles", angles_in_);
  addOutPort("state", state_out_);
  service_port_.registerProvider("pan_tilt", "RTC::PanTilt", service_);
  addPort(service_port_);
  bindJoints();
  bind("speed", speed_);
  return RTC::RTC_OK;
}

bool RTCPTZ::has_both() {
  const bool is_complete = part().size() == 2;
  if (!is_complete && std::exchange(was_complete_, false))
    RTC_WARN(("joints must name a pan and a tilt joint, got %zu joints", part().size()));
  was_complete_ = is_complete;
  return is_complete;
}

// The newest angles count.
void RTCPTZ::read_ports() {
  bool is_new = false;
  while (angles_in_.isNew()) is_new = angles_in_.read() || is_new;
  if (!is_new || !has_both()) return;
  for (std::size_t i = 0; i < 2; ++i) {
    note(part().set_speed(i, speed_ * part().joint(i).max_velocity));
    note(part().move(i, i == 0 ? angles_.pan : angles_.tilt));
  }
}

void RTCPTZ::publish(const shm::Stamp& stamp) {
  if (!has_both()) return;
  state_.tm = state_.angles.tm = iface::to_time(stamp.sim_time_ns);
  state_.angles.pan = part().state(0).position;
  state_.angles.tilt = part().state(1).position;
  state_.panSpeed = part().state(0).velocity;
  state_.tiltSpeed = part().state(1).velocity;
  state_out_.write();
}

extern "C" {
void RTCPTZInit(RTC::Manager* manager) { iface::register_type<RTCPTZ>(manager, specification); }
}
