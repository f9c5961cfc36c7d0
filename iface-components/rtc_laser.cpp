#include "rtc_laser.h"

#include <algorithm>

#include "conversions.h"
#include "specification.h"

// clang-format off
static const char* const rtclaser_spec[] = {
    "implementation_id", "RTCLaser",
    "type_name", "RTCLaser",
    "description", "Laser scanner of a simulated robot",
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
    "conf.default.device_id", "pioneer2dx::laser",
    "conf.default.layer", "-1",
    "conf.__type__.server_id", "int",
    "conf.__type__.device_id", "string",
    "conf.__type__.layer", "int",
    "conf.__widget__.server_id", "spin",
    "conf.__widget__.device_id", "text",
    "conf.__widget__.layer", "spin",
    "conf.__constraints__.server_id", "0<=x<=9999",
    ""};
// clang-format on

RTCLaser::RTCLaser(RTC::Manager* manager) : IfaceComponent(manager, shm::IfaceType::laser, true), range_out_("range", range_) {}

RTC::ReturnCode_t RTCLaser::onInitialize() {
  addOutPort("range", range_out_);
  bindDevice("pioneer2dx::laser");
  bindParameter("layer", layer_, "-1");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t RTCLaser::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  auto* laser = link().fresh(iface::wait_limit());
  if (!laser) return RTC::RTC_OK;
  const auto scan = laser->laser_scan();
  if (!scan.sample->stamp.valid) return RTC::RTC_OK;
  const auto& info = laser->info<shm::LaserInfo>();
  const auto layer = layer_ < 0 ? iface::level_layer(info) : std::min(static_cast<std::uint32_t>(layer_), std::max(info.layers, 1u) - 1);
  iface::to_range_data(info, scan, layer, range_);
  range_out_.write();
  return RTC::RTC_OK;
}

extern "C" {
void RTCLaserInit(RTC::Manager* manager) {
  coil::Properties profile = iface::specification(rtclaser_spec);
  manager->registerFactory(profile, RTC::Create<RTCLaser>, RTC::Delete<RTCLaser>);
}
}
