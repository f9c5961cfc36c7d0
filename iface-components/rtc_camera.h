// RTCCamera: carries a camera iface to the OutPorts `image` (RTC::CameraImage) and `timed_image` (Img::TimedCameraImage; only when
// connected). Rows from top to bottom, pixels from left to right; format "RGB8" (octets r g b), "MONO8" or "JPEG".
// Configuration: server_id, device_id; encoding raw or jpeg, quality 1..100 of the latter.
#pragma once

#include <rtm/DataOutPort.h>
#include <rtm/ext/CameraCommonInterfaceSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <string>

#include "iface_component.h"
#include "jpeg.h"

class RTCCamera : public iface::IfaceComponent {
 public:
  explicit RTCCamera(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  void send_image(const shm::HeldFrame& frame, std::span<const std::byte> pixels, bool is_jpeg);
  void send_timed_image(const shm::CameraInfo& info, const shm::HeldFrame& frame, std::span<const std::byte> pixels, bool is_jpeg);

  std::string encoding_ = "raw";
  int quality_ = 90;
  iface::JpegEncoder jpeg_;
  std::string said_;
  RTC::CameraImage image_;
  RTC::OutPort<RTC::CameraImage> image_out_;
  Img::TimedCameraImage timed_image_;
  RTC::OutPort<Img::TimedCameraImage> timed_image_out_;
};

extern "C" {
DLL_EXPORT void RTCCameraInit(RTC::Manager* manager);
}
