// RTCDepthCamera: bridges a depth iface to the OutPorts `depth` (RTC::CameraImage, format "DEPTH32F": 32-bit little-endian floats, metres
// along the optical axis, 0 where there is nothing) and `points` (RTC::PointCloud in the sensor's frame: x forward, y left, z up).
// Each is computed only when it is connected. Configuration: server_id, device_id; points_step: every n-th pixel of every n-th row.
#pragma once

#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include <vector>

#include "iface_component.h"

class RTCDepthCamera : public iface::IfaceComponent {
 public:
  explicit RTCDepthCamera(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  void send_depth(const shm::HeldFrame& frame);
  void send_points(const shm::CameraInfo& info, const shm::HeldFrame& frame);

  int points_step_ = 4;
  RTC::CameraImage depth_;
  RTC::OutPort<RTC::CameraImage> depth_out_;
  RTC::PointCloud points_;
  RTC::OutPort<RTC::PointCloud> points_out_;
};

extern "C" {
DLL_EXPORT void RTCDepthCameraInit(RTC::Manager* manager);
}
