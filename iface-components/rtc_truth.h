// RTCTruth: bridges the truth iface of a model to the OutPorts `pose` (RTC::TimedPose3D: in the world, m and rad) and `velocity`
// (RTC::TimedVelocity3D: along and about the axes of the world, m/s and rad/s). Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/ExtendedDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCTruth : public iface::IfaceComponent {
 public:
  explicit RTCTruth(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::TimedPose3D pose_;
  RTC::OutPort<RTC::TimedPose3D> pose_out_;
  RTC::TimedVelocity3D velocity_;
  RTC::OutPort<RTC::TimedVelocity3D> velocity_out_;
};

extern "C" {
DLL_EXPORT void RTCTruthInit(RTC::Manager* manager);
}
