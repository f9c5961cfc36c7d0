#include "rtc_altimeter.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCAltimeter",
    .description = "Altimeter of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::altimeter",
};

RTCAltimeter::RTCAltimeter(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::altimeter, true),
      height_out_("height", height_),
      climb_out_("climb", climb_) {}

RTC::ReturnCode_t RTCAltimeter::onInitialize() {
  addOutPort("height", height_out_);
  addOutPort("climb", climb_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCAltimeter::publish(const shm::Iface& device) {
  const auto& sample = device.sample<shm::AltimeterSample>();
  height_.tm = climb_.tm = iface::to_time(sample.stamp.sim_time_ns);
  height_.data = sample.height;
  climb_.data = sample.climb;
  height_out_.write();
  climb_out_.write();
}

extern "C" {
void RTCAltimeterInit(RTC::Manager* manager) { iface::register_type<RTCAltimeter>(manager, specification); }
}
