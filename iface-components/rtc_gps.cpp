#include "rtc_gps.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCGps",
    .description = "Satellite positioning of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::gps",
};

RTCGps::RTCGps(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::gps, true), position_out_("position", position_), service_port_("gps") {}

RTC::ReturnCode_t RTCGps::onInitialize() {
  addOutPort("position", position_out_);
  service_port_.registerProvider("gps", "RTC::GPS", service_);
  addPort(service_port_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCGps::describe(const shm::Iface& gps) { service_.describe(iface::to_geometry(gps.info<shm::GpsInfo>().pose)); }

// Samples without a fix are sent, too.
RTC::ReturnCode_t RTCGps::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  auto* device = link().fresh(iface::wait_limit());
  if (!device) return RTC::RTC_OK;
  const auto& sample = device->sample<shm::GpsSample>();
  iface::to_gps_data(device->info<shm::GpsInfo>(), sample, position_);
  position_out_.write();
  return RTC::RTC_OK;
}

extern "C" {
void RTCGpsInit(RTC::Manager* manager) { iface::register_type<RTCGps>(manager, specification); }
}
