#include "rtc_gps.h"

#include "conversions.h"
#include "specification.h"

// clang-format off
static const char* const rtcgps_spec[] = {
    "implementation_id", "RTCGps",
    "type_name", "RTCGps",
    "description", "Satellite positioning of a simulated robot",
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
    "conf.default.device_id", "pioneer2dx::gps",
    "conf.__type__.server_id", "int",
    "conf.__type__.device_id", "string",
    "conf.__widget__.server_id", "spin",
    "conf.__widget__.device_id", "text",
    "conf.__constraints__.server_id", "0<=x<=9999",
    ""};
// clang-format on

RTCGps::RTCGps(RTC::Manager* manager) : IfaceComponent(manager, shm::IfaceType::gps, true), position_out_("position", position_) {}

RTC::ReturnCode_t RTCGps::onInitialize() {
  addOutPort("position", position_out_);
  bindDevice("pioneer2dx::gps");
  return RTC::RTC_OK;
}

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
void RTCGpsInit(RTC::Manager* manager) {
  coil::Properties profile = iface::specification(rtcgps_spec);
  manager->registerFactory(profile, RTC::Create<RTCGps>, RTC::Delete<RTCGps>);
}
}
