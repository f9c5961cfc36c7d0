#include "rtc_sonar.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCSonar",
    .description = "Sonar ring of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::sonar",
};

RTCSonar::RTCSonar(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::sonar, true), range_out_("range", range_) {}

RTC::ReturnCode_t RTCSonar::onInitialize() {
  addOutPort("range", range_out_);
  bindDevice();
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
void RTCSonarInit(RTC::Manager* manager) { iface::register_type<RTCSonar>(manager, specification); }
}
