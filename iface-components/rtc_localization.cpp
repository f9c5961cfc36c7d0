#include "rtc_localization.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCLocalization",
    .description = "Localization of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::localization",
};

RTCLocalization::RTCLocalization(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::localization, true),
      pose_out_("pose", pose_),
      hypotheses_out_("hypotheses", hypotheses_) {}

RTC::ReturnCode_t RTCLocalization::onInitialize() {
  addOutPort("pose", pose_out_);
  addOutPort("hypotheses", hypotheses_out_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCLocalization::publish(const shm::Iface& device) {
  const auto found = device.elements<shm::Hypothesis>();
  pose_.tm = hypotheses_.tm = iface::to_time(device.sample<shm::LocalizationSample>().stamp.sim_time_ns);
  hypotheses_.hypotheses.length(static_cast<CORBA::ULong>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& [pose, c, weight] = found[i];
    hypotheses_.hypotheses[static_cast<CORBA::ULong>(i)] = {{{pose[0], pose[1]}, pose[2]}, {c[0], c[1], c[2], c[3], c[4], c[5]}, weight};
  }
  hypotheses_out_.write();
  if (found.empty()) return;
  pose_.data = hypotheses_.hypotheses[0].mean;
  pose_out_.write();
}

extern "C" {
void RTCLocalizationInit(RTC::Manager* manager) { iface::register_type<RTCLocalization>(manager, specification); }
}
