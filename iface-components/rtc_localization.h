// RTCLocalization: bridges a localization iface to the OutPorts `hypotheses` (RTC::Hypotheses2D, the best first) and `pose`
// (RTC::TimedPose2D: the best one). In the world [m, rad]. Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCLocalization : public iface::IfaceComponent {
 public:
  explicit RTCLocalization(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedPose2D pose_;
  RTC::OutPort<RTC::TimedPose2D> pose_out_;
  RTC::Hypotheses2D hypotheses_;
  RTC::OutPort<RTC::Hypotheses2D> hypotheses_out_;
};

extern "C" {
DLL_EXPORT void RTCLocalizationInit(RTC::Manager* manager);
}
