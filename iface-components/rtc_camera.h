// RTCCamera: bridges a camera iface to the OutPorts `image` (RTC::CameraImage) and `timed_image` (Img::TimedCameraImage; only when
// connected). Rows from top to bottom, pixels from left to right, without gaps. The camera's world chooses the format: docs/cameras.md
// has the table of names and bytes. Service port `camera` (RTC::Camera; focal length and principal point in pixels). Configuration:
// server_id, device_id; encoding raw or jpeg, quality 1..100 of the latter.
#pragma once

#include <rtm/ext/CameraCommonInterfaceSkel.h>
#include <rtm/ext/CameraSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataOutPort.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "camera_image.h"
#include "geometry_service.h"
#include "iface_component.h"

// Calls from any thread.
class CameraService : public iface::GeometryService<POA_RTC::Camera> {
 public:
  void describe(const shm::CameraInfo& info);
  RTC::CameraInfo GetCameraInfo() override { return *info_.lock(); }

 private:
  base::Guarded<RTC::CameraInfo, base::Rank::details> info_;
};

class RTCCamera : public iface::IfaceComponent {
 public:
  explicit RTCCamera(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;

 protected:
  void describe(const shm::Iface& camera) override { service_.describe(camera.info<shm::CameraInfo>()); }

 private:
  void count(std::uint64_t sequence);
  void send_image(const shm::FrameHead& head, std::span<const std::byte> pixels, bool is_jpeg);
  void send_timed_image(const shm::CameraInfo& info, const shm::FrameHead& head, std::span<const std::byte> pixels, bool is_jpeg);

  std::string encoding_ = "raw";
  int quality_ = 90;
  base::JpegEncoder jpeg_;
  std::string said_;
  std::uint64_t sent_ = 0, missed_ = 0, last_ = 0, attachments_ = 0;
  std::vector<std::byte> packed_, converted_;
  RTC::CameraImage image_;
  RTC::OutPort<RTC::CameraImage> image_out_;
  Img::TimedCameraImage timed_image_;
  RTC::OutPort<Img::TimedCameraImage> timed_image_out_;
  RTC::CorbaPort service_port_;
  CameraService service_;
};

extern "C" {
DLL_EXPORT void RTCCameraInit(RTC::Manager* manager);
}
