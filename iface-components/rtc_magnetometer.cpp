#include "rtc_magnetometer.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCMagnetometer",
    .description = "Magnetometer of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::magnetometer",
};

RTCMagnetometer::RTCMagnetometer(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::magnetometer, true), field_out_("field", field_) {}

RTC::ReturnCode_t RTCMagnetometer::onInitialize() {
  addOutPort("field", field_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCMagnetometer::publish(const shm::Iface& device) {
  const auto& sample = device.sample<shm::MagnetometerSample>();
  field_.tm = iface::to_time(sample.stamp.sim_time_ns);
  field_.data = {sample.field[0], sample.field[1], sample.field[2]};
  field_out_.write();
}

extern "C" {
void RTCMagnetometerInit(RTC::Manager* manager) { iface::register_type<RTCMagnetometer>(manager, specification); }
}
