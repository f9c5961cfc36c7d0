#include "rtc_sonar.h"

#include "conversions.h"
#include "specification.h"

// clang-format off
static const char* const rtcsonar_spec[] = {
    "implementation_id", "RTCSonar",
    "type_name", "RTCSonar",
    "description", "Sonar ring of a simulated robot",
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
    "conf.default.device_id", "pioneer2dx::sonar",
    "conf.__type__.server_id", "int",
    "conf.__type__.device_id", "string",
    "conf.__widget__.server_id", "spin",
    "conf.__widget__.device_id", "text",
    "conf.__constraints__.server_id", "0<=x<=9999",
    ""};
// clang-format on

RTCSonar::RTCSonar(RTC::Manager* manager) : IfaceComponent(manager, shm::IfaceType::sonar, true), range_out_("range", range_) {}

RTC::ReturnCode_t RTCSonar::onInitialize() {
  addOutPort("range", range_out_);
  bindDevice("pioneer2dx::sonar");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t RTCSonar::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  auto* device = link().fresh(iface::wait_limit());
  if (!device) return RTC::RTC_OK;
  const auto scan = device->sonar_scan();
  if (!scan.sample->stamp.valid) return RTC::RTC_OK;
  iface::to_range_data(device->info<shm::SonarInfo>(), device->sonar_poses(), scan, range_);
  range_out_.write();
  return RTC::RTC_OK;
}

extern "C" {
void RTCSonarInit(RTC::Manager* manager) {
  coil::Properties profile = iface::specification(rtcsonar_spec);
  manager->registerFactory(profile, RTC::Create<RTCSonar>, RTC::Delete<RTCSonar>);
}
}
