#include "rtc_depth_camera.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCDepthCamera",
    .description = "Depth camera of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "helicopter::depth",
    .parameters = {{"points_step", "4", "int", "spin", "1<=x<=64"}},
};

RTCDepthCamera::RTCDepthCamera(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::depth, true), depth_out_("depth", depth_), points_out_("points", points_) {}

RTC::ReturnCode_t RTCDepthCamera::onInitialize() {
  addOutPort("depth", depth_out_);
  addOutPort("points", points_out_);
  bindDevice();
  bind("points_step", points_step_);
  return RTC::RTC_OK;
}

RTC::ReturnCode_t RTCDepthCamera::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  const auto frame = link().fresh_frame(iface::wait_limit());
  auto* camera = link().live();
  if (!frame || !camera || !frame->head().stamp.valid) return RTC::RTC_OK;
  if (!depth_out_.connectors().empty()) send_depth(*frame);
  if (!points_out_.connectors().empty()) send_points(camera->info<shm::CameraInfo>(), *frame);
  return RTC::RTC_OK;
}

namespace {

// Row and column must be inside the frame; what is not finite is 0.
float depth_at(const shm::HeldFrame& frame, std::uint32_t row, std::uint32_t column) {
  const auto offset = static_cast<std::size_t>(row) * frame.head().stride + column * sizeof(float);
  float depth = 0;
  if (offset + sizeof depth <= frame.data().size()) std::memcpy(&depth, frame.data().data() + offset, sizeof depth);
  return std::isfinite(depth) ? depth : 0;
}

}  // namespace

void RTCDepthCamera::send_depth(const shm::HeldFrame& frame) {
  const auto& head = frame.head();
  depth_.tm = iface::to_time(head.stamp.sim_time_ns);
  depth_.width = static_cast<CORBA::UShort>(head.width);
  depth_.height = static_cast<CORBA::UShort>(head.height);
  depth_.bpp = 32;
  depth_.format = CORBA::string_dup("DEPTH32F");
  depth_.fDiv = 1;
  depth_.pixels.length(static_cast<CORBA::ULong>(sizeof(float) * head.width * head.height));
  std::size_t at = 0;
  for (std::uint32_t row = 0; row < head.height; ++row) {
    for (std::uint32_t column = 0; column < head.width; ++column, at += sizeof(float)) {
      const float depth = depth_at(frame, row, column);
      std::memcpy(&depth_.pixels[static_cast<CORBA::ULong>(at)], &depth, sizeof depth);
    }
  }
  depth_out_.write();
}

void RTCDepthCamera::send_points(const shm::CameraInfo& info, const shm::HeldFrame& frame) {
  const auto& head = frame.head();
  const auto step = static_cast<std::uint32_t>(std::clamp(points_step_, 1, 64));
  points_.tm = iface::to_time(head.stamp.sim_time_ns);
  points_.points.length(((head.height + step - 1) / step) * ((head.width + step - 1) / step));
  CORBA::ULong count = 0;
  for (std::uint32_t row = 0; row < head.height; row += step) {
    for (std::uint32_t column = 0; column < head.width; column += step) {
      const double depth = depth_at(frame, row, column);
      if (depth <= 0) continue;
      auto& point = points_.points[count++];
      const auto ray = iface::to_ray(info, column + 0.5, row + 0.5);
      point.point = {depth, -ray.right * depth, -ray.down * depth};
      point.colour = {1, 1, 1};
    }
  }
  points_.points.length(count);
  points_out_.write();
}

extern "C" {
void RTCDepthCameraInit(RTC::Manager* manager) { iface::register_type<RTCDepthCamera>(manager, specification); }
}
