#include "rtc_dvl.h"

#include <algorithm>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCDvl",
    .description = "Doppler velocity log of a simulated vehicle",
    .phase = iface::sensor_phase,
    .device = "tethys::dvl",
};

RTCDvl::RTCDvl(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::dvl, true),
      velocity_out_("velocity", velocity_),
      range_out_("range", range_),
      ranges_out_("ranges", ranges_) {}

RTC::ReturnCode_t RTCDvl::onInitialize() {
  addOutPort("velocity", velocity_out_);
  addOutPort("range", range_out_);
  addOutPort("ranges", ranges_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCDvl::publish(const shm::Iface& device) {
  const auto& sample = device.sample<shm::DvlSample>();
  const double farthest = device.info<shm::DvlInfo>().max_range;
  const auto echoes = device.elements<shm::DvlEcho>();
  velocity_.tm = range_.tm = ranges_.tm = iface::to_time(sample.stamp.sim_time_ns);
  velocity_.data = {sample.velocity[0], sample.velocity[1], sample.velocity[2], 0, 0, 0};
  range_.data = std::min(sample.range, farthest);
  ranges_.data.length(static_cast<CORBA::ULong>(echoes.size()));
  for (std::size_t i = 0; i < echoes.size(); ++i) ranges_.data[static_cast<CORBA::ULong>(i)] = std::min(echoes[i].range, farthest);
  if (sample.has_velocity != 0) velocity_out_.write();
  range_out_.write();
  ranges_out_.write();
}

extern "C" {
void RTCDvlInit(RTC::Manager* manager) { iface::register_type<RTCDvl>(manager, specification); }
}
