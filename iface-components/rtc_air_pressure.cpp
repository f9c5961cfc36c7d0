#include "rtc_air_pressure.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCAirPressure",
    .description = "Air pressure sensor of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::air_pressure",
};

RTCAirPressure::RTCAirPressure(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::air_pressure, true), pressure_out_("pressure", pressure_) {}

RTC::ReturnCode_t RTCAirPressure::onInitialize() {
  addOutPort("pressure", pressure_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCAirPressure::publish(const shm::Iface& device) {
  const auto& sample = device.sample<shm::AirPressureSample>();
  pressure_.tm = iface::to_time(sample.stamp.sim_time_ns);
  pressure_.data = sample.pressure;
  pressure_out_.write();
}

extern "C" {
void RTCAirPressureInit(RTC::Manager* manager) { iface::register_type<RTCAirPressure>(manager, specification); }
}
