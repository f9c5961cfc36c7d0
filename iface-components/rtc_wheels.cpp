#include "rtc_wheels.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCWheels",
    .description = "Wheel encoders of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::wheels",
};

RTCWheels::RTCWheels(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::wheels, true),
      angles_out_("angles", angles_),
      speeds_out_("speeds", speeds_),
      ticks_out_("ticks", ticks_) {}

RTC::ReturnCode_t RTCWheels::onInitialize() {
  addOutPort("angles", angles_out_);
  addOutPort("speeds", speeds_out_);
  addOutPort("ticks", ticks_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCWheels::publish(const shm::Iface& device) {
  const auto encoders = device.elements<shm::WheelState>();
  angles_.tm = speeds_.tm = ticks_.tm = iface::to_time(device.sample<shm::WheelsSample>().stamp.sim_time_ns);
  const auto count = static_cast<CORBA::ULong>(encoders.size());
  angles_.data.length(count);
  speeds_.data.length(count);
  ticks_.data.length(count);
  for (CORBA::ULong i = 0; i < count; ++i) {
    angles_.data[i] = encoders[i].angle;
    speeds_.data[i] = encoders[i].speed;
    // Counters of 32 bits begin again.
    ticks_.data[i] = static_cast<CORBA::Long>(static_cast<std::uint32_t>(static_cast<std::int64_t>(encoders[i].ticks)));
  }
  angles_out_.write();
  speeds_out_.write();
  ticks_out_.write();
}

extern "C" {
void RTCWheelsInit(RTC::Manager* manager) { iface::register_type<RTCWheels>(manager, specification); }
}
