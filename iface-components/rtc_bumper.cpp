#include "rtc_bumper.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCBumper",
    .description = "Contact sensor of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::bumper",
};

RTCBumper::RTCBumper(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::bumper, true),
      contact_out_("contact", contact_),
      force_out_("force", force_),
      service_port_("bumper") {}

RTC::ReturnCode_t RTCBumper::onInitialize() {
  addOutPort("contact", contact_out_);
  addOutPort("force", force_out_);
  service_port_.registerProvider("bumper", "RTC::Bumper", service_);
  service_port_.registerProvider("dio", "RTC::DIO", bit_);
  addPort(service_port_);
  bindDevice();
  return RTC::RTC_OK;
}

CORBA::Boolean ContactBit::GetBit(CORBA::UShort index) {
  if (index != 0) throw CORBA::BAD_PARAM();
  return is_set_.load(std::memory_order_relaxed);
}

void ContactBit::SetBit(CORBA::UShort, CORBA::Boolean) { throw CORBA::NO_PERMISSION(); }

void RTCBumper::describe(const shm::Iface& bumper) {
  const auto& info = bumper.info<shm::BumperInfo>();
  service_.describe({iface::to_pose(info.middle), {info.size[0], info.size[1], info.size[2]}, info.radius});
}

void RTCBumper::publish(const shm::Iface& bumper) {
  const auto view = bumper.bumper();
  contact_.tm = force_.tm = iface::to_time(view.sample->stamp.sim_time_ns);
  contact_.data.length(1);
  contact_.data[0] = view.sample->total > 0;
  bit_.show(view.sample->total > 0);
  force_.data.length(static_cast<CORBA::ULong>(3 * view.contacts.size()));
  for (std::size_t i = 0; i < view.contacts.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) force_.data[static_cast<CORBA::ULong>(3 * i + axis)] = view.contacts[i].force[axis];
  }
  contact_out_.write();
  force_out_.write();
}

extern "C" {
void RTCBumperInit(RTC::Manager* manager) { iface::register_type<RTCBumper>(manager, specification); }
}
