// RTCBoundingBoxes: bridges a boxes iface to the OutPorts `labels` (RTC::TimedStringSeq: label and scoped name of each box, "7 town::car")
// and `boxes` (RTC::TimedDoubleSeq, in the same order): label, centre x y, width, height [pixel] of boxes in the image; label, x y z of the
// centre [m], roll, pitch, yaw [rad], length, width, height [m] of oriented ones, in the camera (x forward). The time is that of the image
// that RTCCamera sends of the same sensor. Configuration: server_id, device_id.
#pragma once

#include <rtm/DataOutPort.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include "iface_component.h"

class RTCBoundingBoxes : public iface::IfaceComponent {
 public:
  explicit RTCBoundingBoxes(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& boxes) override;

 private:
  RTC::TimedStringSeq labels_;
  RTC::OutPort<RTC::TimedStringSeq> labels_out_;
  RTC::TimedDoubleSeq boxes_;
  RTC::OutPort<RTC::TimedDoubleSeq> boxes_out_;
};

extern "C" {
DLL_EXPORT void RTCBoundingBoxesInit(RTC::Manager* manager);
}
