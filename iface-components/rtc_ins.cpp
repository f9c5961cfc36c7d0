#include "rtc_ins.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCIns",
    .description = "Inertial navigation system of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::ins",
};

RTCIns::RTCIns(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::ins, true), position_out_("position", position_), service_port_("ins") {}

RTC::ReturnCode_t RTCIns::onInitialize() {
  addOutPort("position", position_out_);
  service_port_.registerProvider("ins", "RTC::INS", service_);
  addPort(service_port_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCIns::describe(const shm::Iface& ins) { service_.describe(iface::to_geometry(ins.info<shm::InsInfo>().pose)); }

void RTCIns::publish(const shm::Iface& device) {
  const auto& sample = device.sample<shm::InsSample>();
  position_.tm = iface::to_time(sample.stamp.sim_time_ns);
  position_.latitude = sample.latitude;
  position_.longitude = sample.longitude;
  position_.altitude = sample.altitude;
  position_.heightAMSL = sample.altitude;  // the geoid is the ellipsoid
  position_.velocityENU = {sample.velocity[0], sample.velocity[1], sample.velocity[2], 0, 0, 0};
  position_.orientation = {sample.orientation[0], sample.orientation[1], sample.orientation[2]};
  position_out_.write();
}

extern "C" {
void RTCInsInit(RTC::Manager* manager) { iface::register_type<RTCIns>(manager, specification); }
}
