#include "rtc_air_speed.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCAirSpeed",
    .description = "Air speed sensor of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "plane::air_speed",
};

RTCAirSpeed::RTCAirSpeed(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::air_speed, true),
      pressure_out_("pressure", pressure_),
      temperature_out_("temperature", temperature_) {}

RTC::ReturnCode_t RTCAirSpeed::onInitialize() {
  addOutPort("pressure", pressure_out_);
  addOutPort("temperature", temperature_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCAirSpeed::publish(const shm::Iface& device) {
  const auto& sample = device.sample<shm::AirSpeedSample>();
  pressure_.tm = temperature_.tm = iface::to_time(sample.stamp.sim_time_ns);
  pressure_.data = sample.pressure;
  temperature_.data = sample.temperature;
  pressure_out_.write();
  temperature_out_.write();
}

extern "C" {
void RTCAirSpeedInit(RTC::Manager* manager) { iface::register_type<RTCAirSpeed>(manager, specification); }
}
