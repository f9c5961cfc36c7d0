// RTCLogicalCamera: bridges a logical_camera iface to the OutPorts `models` (RTC::TimedStringSeq: scoped names) and `fiducials`
// (RTC::Fiducials: poses in the camera, in the same order; id: index into the names). Configuration: server_id, device_id.
#pragma once

#include <rtm/DataOutPort.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include "iface_component.h"

class RTCLogicalCamera : public iface::IfaceComponent {
 public:
  explicit RTCLogicalCamera(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& camera) override;

 private:
  RTC::TimedStringSeq models_;
  RTC::OutPort<RTC::TimedStringSeq> models_out_;
  RTC::Fiducials fiducials_;
  RTC::OutPort<RTC::Fiducials> fiducials_out_;
};

extern "C" {
DLL_EXPORT void RTCLogicalCameraInit(RTC::Manager* manager);
}
