#include "rtc_multicamera.h"

#include <base/text.h>
#include <shm/segment.h>

#include <algorithm>

#include "conversions.h"

static const iface::Specification specification{
    .type_name = "RTCMulticamera",
    .description = "Cameras of a simulated robot that take their images at the same time",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::stereo",
    .parameters = {{"cameras", "", "string", "text"}},
};

void MulticameraService::describe(const std::vector<shm::CameraInfo>& cameras) {
  auto state = state_.lock();
  const auto count = static_cast<CORBA::ULong>(cameras.size());
  state->geometry = RTC::MulticameraGeometry{};
  state->geometry.cameraGeometries.length(count);
  state->infos.length(count);
  for (CORBA::ULong i = 0; i < count; ++i) {
    const shm::CameraInfo& info = cameras[i];
    const auto& d = info.distortion;  // k1 k2 p1 p2 k3
    state->geometry.cameraGeometries[i] = iface::to_geometry(info.pose);
    state->infos[i] = {{info.fx, info.fy}, {info.cx, info.cy}, d[0], d[1], d[2], d[3]};
  }
  if (count > 0) state->geometry.geometry = state->geometry.cameraGeometries[0];
}

RTCMulticamera::RTCMulticamera(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager), images_out_("images", images_), service_port_("multicamera") {}

RTC::ReturnCode_t RTCMulticamera::onInitialize() {
  addOutPort("images", images_out_);
  service_port_.registerProvider("multicamera", "RTC::Multicamera", service_);
  addPort(service_port_);
  bindParameter("server_id", server_id_, std::to_string(iface::default_server()).c_str());
  bindParameter("device_id", device_id_, specification.device);
  bindParameter("cameras", cameras_, specification.value_of("cameras"));
  return RTC::RTC_OK;
}

std::vector<std::string> RTCMulticamera::wanted() const {
  std::vector<std::string> names;
  for (const auto& camera : base::split_list(cameras_)) names.push_back(device_id_ + "::" + camera);
  if (!names.empty()) return names;
  for (const auto& found : shm::find_segments(static_cast<std::uint32_t>(std::max(server_id_, 0)))) {
    const auto& name = found.name;
    if (name.type == shm::IfaceType::camera && name.iface.starts_with(device_id_ + "::")) names.push_back(name.iface);
  }
  std::ranges::sort(names);
  return names;
}

bool RTCMulticamera::attach() {
  eyes_.clear();
  attached_to_ = std::to_string(server_id_) + device_id_ + cameras_;
  auto names = wanted();
  if (names.empty()) names.push_back(device_id_ + "::left");  // its error says what there is instead
  for (const auto& name : names) {
    const auto say = [this](bool is_problem, const std::string& line) {
      if (is_problem) {
        RTC_WARN(("%s", line.c_str()));
      } else {
        RTC_INFO(("%s", line.c_str()));
      }
    };
    Eye eye{iface::IfaceLink(shm::IfaceType::camera, say), std::nullopt, {}};
    if (const auto done = eye.link.attach({server_id_, name}, true); !done) {
      if (const auto line = limit_.next(done.error().message)) RTC_ERROR(("%s", line->c_str()));
      eyes_.clear();
      return false;
    }
    eyes_.push_back(std::move(eye));
  }
  describe_when_new();
  return true;
}

void RTCMulticamera::describe_when_new() {
  if (std::ranges::none_of(eyes_, [](const Eye& eye) { return eye.described != eye.link.attachments(); })) return;
  std::vector<shm::CameraInfo> infos;
  for (Eye& eye : eyes_) {
    const auto* camera = eye.link.live();
    if (camera == nullptr) return;
    infos.push_back(camera->info<shm::CameraInfo>());
  }
  for (Eye& eye : eyes_) eye.described = eye.link.attachments();
  service_.describe(infos);
}

RTC::ReturnCode_t RTCMulticamera::onActivated(RTC::UniqueId) { return attach() ? RTC::RTC_OK : RTC::RTC_ERROR; }

RTC::ReturnCode_t RTCMulticamera::onDeactivated(RTC::UniqueId) {
  eyes_.clear();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t RTCMulticamera::onAborting(RTC::UniqueId) {
  eyes_.clear();
  return RTC::RTC_OK;
}

bool RTCMulticamera::are_together() {
  std::int64_t newest = -1;
  for (const Eye& eye : eyes_) {
    if (eye.frame) newest = std::max(newest, eye.frame->head().stamp.sim_time_ns);
  }
  for (Eye& eye : eyes_) {
    if (eye.frame && eye.frame->head().stamp.sim_time_ns < newest) eye.frame.reset();
  }
  return std::ranges::all_of(eyes_, [](const Eye& eye) { return eye.frame.has_value(); });
}

RTC::ReturnCode_t RTCMulticamera::onExecute(RTC::UniqueId) {
  if (attached_to_ != std::to_string(server_id_) + device_id_ + cameras_ && !attach()) return RTC::RTC_ERROR;
  describe_when_new();
  for (Eye& eye : eyes_) {
    if (auto frame = eye.link.fresh_frame(iface::wait_limit()); frame && frame->head().stamp.valid != 0) eye.frame = std::move(frame);
  }
  if (are_together()) send();
  return RTC::RTC_OK;
}

void RTCMulticamera::send() {
  images_.images.length(static_cast<CORBA::ULong>(eyes_.size()));
  for (CORBA::ULong i = 0; i < images_.images.length(); ++i) {
    Eye& eye = eyes_[i];
    const auto& head = eye.frame->head();
    const auto pixels = iface::packed(head, eye.frame->data(), eye.packed);
    const auto format = iface::image_format(static_cast<shm::Format>(head.format));
    RTC::CameraImage& image = images_.images[i];
    image.tm = images_.tm = iface::to_time(head.stamp.sim_time_ns);
    image.width = static_cast<CORBA::UShort>(head.width);
    image.height = static_cast<CORBA::UShort>(head.height);
    image.bpp = format.bits;
    image.format = CORBA::string_dup(format.name);
    image.fDiv = 1;
    image.pixels.length(static_cast<CORBA::ULong>(pixels.size()));
    std::copy_n(reinterpret_cast<const CORBA::Octet*>(pixels.data()), pixels.size(), image.pixels.get_buffer());
    eye.frame.reset();
  }
  images_out_.write();
}

extern "C" {
void RTCMulticameraInit(RTC::Manager* manager) { iface::register_type<RTCMulticamera>(manager, specification); }
}
