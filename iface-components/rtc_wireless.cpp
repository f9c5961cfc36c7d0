#include "rtc_wireless.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCWireless",
    .description = "Wireless receiver of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::wireless",
};

RTCWireless::RTCWireless(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::wireless, true),
      essids_out_("essids", essids_),
      levels_out_("levels", levels_) {}

RTC::ReturnCode_t RTCWireless::onInitialize() {
  addOutPort("essids", essids_out_);
  addOutPort("levels", levels_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCWireless::publish(const shm::Iface& device) {
  const auto found = device.elements<shm::Radio>();
  essids_.tm = levels_.tm = iface::to_time(device.sample<shm::WirelessSample>().stamp.sim_time_ns);
  essids_.data.length(static_cast<CORBA::ULong>(found.size()));
  levels_.data.length(static_cast<CORBA::ULong>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    essids_.data[static_cast<CORBA::ULong>(i)] = found[i].essid;
    levels_.data[static_cast<CORBA::ULong>(i)] = found[i].level;
  }
  essids_out_.write();
  levels_out_.write();
}

extern "C" {
void RTCWirelessInit(RTC::Manager* manager) { iface::register_type<RTCWireless>(manager, specification); }
}
