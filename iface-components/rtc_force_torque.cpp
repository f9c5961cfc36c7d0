#include "rtc_force_torque.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCForceTorque",
    .description = "Force and torque sensor of a simulated joint",
    .phase = iface::sensor_phase,
    .device = "arm::force_torque",
};

RTCForceTorque::RTCForceTorque(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::force_torque, true), force_out_("force", force_) {}

RTC::ReturnCode_t RTCForceTorque::onInitialize() {
  addOutPort("force", force_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCForceTorque::publish(const shm::Iface& device) {
  const auto& sample = device.sample<shm::ForceTorqueSample>();
  force_.tm = iface::to_time(sample.stamp.sim_time_ns);
  force_.data.length(6);
  for (CORBA::ULong axis = 0; axis < 3; ++axis) {
    force_.data[axis] = sample.force[axis];
    force_.data[3 + axis] = sample.torque[axis];
  }
  force_out_.write();
}

extern "C" {
void RTCForceTorqueInit(RTC::Manager* manager) { iface::register_type<RTCForceTorque>(manager, specification); }
}
