#include "rtc_truth.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCTruth",
    .description = "True pose and velocity of a simulated model",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx",
};

RTCTruth::RTCTruth(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::truth, true), pose_out_("pose", pose_), velocity_out_("velocity", velocity_) {}

RTC::ReturnCode_t RTCTruth::onInitialize() {
  addOutPort("pose", pose_out_);
  addOutPort("velocity", velocity_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCTruth::publish(const shm::Iface& device) {
  const auto& sample = device.sample<shm::TruthSample>();
  pose_.tm = velocity_.tm = iface::to_time(sample.stamp.sim_time_ns);
  const auto& v = sample.velocity;
  pose_.data = iface::to_pose(sample.pose);
  velocity_.data = {v[0], v[1], v[2], v[3], v[4], v[5]};
  pose_out_.write();
  velocity_out_.write();
}

extern "C" {
void RTCTruthInit(RTC::Manager* manager) { iface::register_type<RTCTruth>(manager, specification); }
}
