#include "rtc_sonar.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCSonar",
    .description = "Sonar ring of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::sonar",
};

RTCSonar::RTCSonar(RTC::Manager* manager) : RangerComponent(manager, specification, shm::IfaceType::sonar), range_out_("range", range_) {}

RTC::ReturnCode_t RTCSonar::onInitialize() {
  addOutPort("range", range_out_);
  addRangerPort();
  bindDevice();
  return RTC::RTC_OK;
}

void RTCSonar::describe(const shm::Iface& sonar) {
  const auto& info = sonar.info<shm::SonarInfo>();
  service().describe(iface::ranger_geometry(info, sonar.sonar_poses()), iface::ranger_config(info));
}

void RTCSonar::publish(const shm::Iface& sonar) {
  iface::to_range_data(sonar.info<shm::SonarInfo>(), sonar.sonar_poses(), sonar.sonar_scan(), range_);
  if (const auto wanted = service().wanted()) iface::cut(*wanted, range_);
  range_out_.write();
}

extern "C" {
void RTCSonarInit(RTC::Manager* manager) { iface::register_type<RTCSonar>(manager, specification); }
}
