#include "rtc_camera.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCCamera",
    .description = "Camera of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "helicopter::camera",
    .parameters = {{"encoding", "raw", "string", "radio", "(raw,jpeg)"}, {"quality", "90", "int", "slider.1", "1<=x<=100"}},
};

namespace {

// A sequence of octets on memory that is somebody else's and stays there while it is sent: no copy.
template <class Sequence>
void borrow(Sequence& sequence, std::span<const std::byte> bytes) {
  const auto length = static_cast<CORBA::ULong>(bytes.size());
  sequence.replace(length, length, reinterpret_cast<CORBA::Octet*>(const_cast<std::byte*>(bytes.data())), false);
}

template <class Sequence>
void give_back(Sequence& sequence) {
  sequence.replace(0, 0, nullptr, false);
}

}  // namespace

void CameraService::describe(const shm::CameraInfo& info) {
  GeometryService::describe(iface::to_geometry(info.pose));
  const auto& d = info.distortion;  // k1 k2 p1 p2 k3
  *info_.lock() = {{info.fx, info.fy}, {info.cx, info.cy}, d[0], d[1], d[2], d[3]};
}

RTCCamera::RTCCamera(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::camera, true),
      image_out_("image", image_),
      timed_image_out_("timed_image", timed_image_),
      service_port_("camera") {}

RTC::ReturnCode_t RTCCamera::onInitialize() {
  addOutPort("image", image_out_);
  addOutPort("timed_image", timed_image_out_);
  service_port_.registerProvider("camera", "RTC::Camera", service_);
  addPort(service_port_);
  bindDevice();
  bind("encoding", encoding_);
  bind("quality", quality_);
  return RTC::RTC_OK;
}

RTC::ReturnCode_t RTCCamera::onActivated(RTC::UniqueId ec_id) {
  sent_ = missed_ = last_ = 0;
  said_.clear();
  return IfaceComponent::onActivated(ec_id);
}

RTC::ReturnCode_t RTCCamera::onDeactivated(RTC::UniqueId ec_id) {
  say_limited(false, std::to_string(sent_) + " frames sent, " + std::to_string(missed_) + " missed");
  return IfaceComponent::onDeactivated(ec_id);
}

// Frames that the camera took while a receiver kept this component waiting are missed.
void RTCCamera::count(std::uint64_t sequence) {
  if (attachments_ == link().attachments() && last_ > 0 && sequence > last_) missed_ += sequence - last_ - 1;
  attachments_ = link().attachments();
  last_ = sequence;
  ++sent_;
}

RTC::ReturnCode_t RTCCamera::onExecute(RTC::UniqueId) {
  if (!follow_configuration()) return RTC::RTC_ERROR;
  const auto frame = link().fresh_frame(iface::wait_limit());
  auto* camera = link().live();
  if (!frame || !camera || !frame->head().stamp.valid) return RTC::RTC_OK;
  count(frame->sequence());
  const auto& head = frame->head();
  auto pixels = iface::packed(head, frame->data(), packed_);
  const bool is_jpeg = encoding_ == "jpeg";
  if (is_jpeg) {
    const auto encoded = iface::to_jpeg(jpeg_, head, pixels, quality_, converted_);
    if (!encoded) {
      if (said_ != encoded.error().message) RTC_ERROR(("%s", encoded.error().message.c_str()));
      said_ = encoded.error().message;
      return RTC::RTC_OK;
    }
    pixels = std::as_bytes(*encoded);
  }
  send_image(head, pixels, is_jpeg);
  if (!timed_image_out_.connectors().empty()) send_timed_image(camera->info<shm::CameraInfo>(), head, pixels, is_jpeg);
  return RTC::RTC_OK;
}

void RTCCamera::send_image(const shm::FrameHead& head, std::span<const std::byte> pixels, bool is_jpeg) {
  const auto format = iface::image_format(static_cast<shm::Format>(head.format));
  image_.tm = iface::to_time(head.stamp.sim_time_ns);
  image_.width = static_cast<CORBA::UShort>(head.width);
  image_.height = static_cast<CORBA::UShort>(head.height);
  image_.bpp = format.bits;
  image_.format = CORBA::string_dup(is_jpeg ? "JPEG" : format.name);
  image_.fDiv = head.unit > 0 ? 1 / head.unit : 1;  // of temperatures [1/K]
  borrow(image_.pixels, pixels);
  image_out_.write();
  give_back(image_.pixels);
}

void RTCCamera::send_timed_image(const shm::CameraInfo& info, const shm::FrameHead& head, std::span<const std::byte> pixels, bool is_jpeg) {
  const auto format = static_cast<shm::Format>(head.format);
  auto& camera = timed_image_.data;
  timed_image_.tm = camera.captured_time = iface::to_time(head.stamp.sim_time_ns);
  camera.image.width = static_cast<CORBA::Long>(head.width);
  camera.image.height = static_cast<CORBA::Long>(head.height);
  camera.image.format = is_jpeg ? Img::CF_JPEG : iface::image_format(format).img;
  borrow(camera.image.raw_data, is_jpeg ? pixels : iface::for_img(format, pixels, converted_));
  // Order of the elements: fx, skew, cx, fy, cy.
  const double intrinsic[5] = {info.fx, 0, info.cx, info.fy, info.cy};
  for (int i = 0; i < 5; ++i) camera.intrinsic.matrix_element[i] = intrinsic[i];
  camera.intrinsic.distortion_coefficient.length(5);
  for (CORBA::ULong i = 0; i < 5; ++i) camera.intrinsic.distortion_coefficient[i] = info.distortion[i];
  const auto& p = head.pose;  // of the camera in the world, as a homogeneous matrix
  const double rotation[3][3] = {{1 - 2 * (p.qy * p.qy + p.qz * p.qz), 2 * (p.qx * p.qy - p.qw * p.qz), 2 * (p.qx * p.qz + p.qw * p.qy)},
                                 {2 * (p.qx * p.qy + p.qw * p.qz), 1 - 2 * (p.qx * p.qx + p.qz * p.qz), 2 * (p.qy * p.qz - p.qw * p.qx)},
                                 {2 * (p.qx * p.qz - p.qw * p.qy), 2 * (p.qy * p.qz + p.qw * p.qx), 1 - 2 * (p.qx * p.qx + p.qy * p.qy)}};
  const double position[3] = {p.x, p.y, p.z};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      camera.extrinsic[row][column] = row == 3 ? (column == 3 ? 1 : 0) : column == 3 ? position[row] : rotation[row][column];
    }
  }
  timed_image_.error_code = 0;
  timed_image_out_.write();
  give_back(camera.image.raw_data);
}

extern "C" {
void RTCCameraInit(RTC::Manager* manager) { iface::register_type<RTCCamera>(manager, specification); }
}
