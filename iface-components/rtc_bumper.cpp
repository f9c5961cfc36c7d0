#include "rtc_bumper.h"

#include "conversions.h"
#include "specification.h"

// clang-format off
static const char* const rtcbumper_spec[] = {
    "implementation_id", "RTCBumper",
    "type_name", "RTCBumper",
    "description", "Contact sensor of a simulated robot",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "simulation",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "1000",
    "exec_cxt.sim_time.phase", "0",
    "conf.default.server_id", "0",
    "conf.default.device_id", "pioneer2dx::bumper",
    "conf.__type__.server_id", "int",
    "conf.__type__.device_id", "string",
    "conf.__widget__.server_id", "spin",
    "conf.__widget__.device_id", "text",
    "conf.__constraints__.server_id", "0<=x<=9999",
    ""};
// clang-format on

RTCBumper::RTCBumper(RTC::Manager* manager)
    : IfaceComponent(manager, shm::IfaceType::bumper, true), contact_out_("contact", contact_), force_out_("force", force_) {}

RTC::ReturnCode_t RTCBumper::onInitialize() {
  addOutPort("contact", contact_out_);
  addOutPort("force", force_out_);
  bindDevice("pioneer2dx::bumper");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t RTCBumper::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  auto* device = link().fresh(iface::wait_limit());
  if (!device) return RTC::RTC_OK;
  const auto view = device->bumper();
  if (!view.sample->stamp.valid) return RTC::RTC_OK;
  contact_.tm = force_.tm = iface::to_time(view.sample->stamp.sim_time_ns);
  contact_.data.length(1);
  contact_.data[0] = view.sample->total > 0;
  force_.data.length(static_cast<CORBA::ULong>(3 * view.contacts.size()));
  for (std::size_t i = 0; i < view.contacts.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) force_.data[static_cast<CORBA::ULong>(3 * i + axis)] = view.contacts[i].force[axis];
  }
  contact_out_.write();
  force_out_.write();
  return RTC::RTC_OK;
}

extern "C" {
void RTCBumperInit(RTC::Manager* manager) {
  coil::Properties profile = iface::specification(rtcbumper_spec);
  manager->registerFactory(profile, RTC::Create<RTCBumper>, RTC::Delete<RTCBumper>);
}
}
