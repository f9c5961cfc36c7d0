#include "channels/views/jpeg.h"

#include <turbojpeg.h>

#include <algorithm>

namespace channels {

namespace {

constexpr int quality = 85;

std::optional<int> turbo_format(shm::Format format) {
  switch (format) {
    case shm::Format::rgb8:
      return TJPF_RGB;
    case shm::Format::bgr8:
      return TJPF_BGR;
    case shm::Format::rgba8:
      return TJPF_RGBX;
    case shm::Format::bgra8:
      return TJPF_BGRX;
    case shm::Format::mono8:
      return TJPF_GRAY;
    default:
      return std::nullopt;
  }
}

}  // namespace

Jpeg::Jpeg() : handle_(tjInitCompress()) {}

Jpeg::~Jpeg() {
  if (buffer_ != nullptr) tjFree(buffer_);
  if (handle_ != nullptr) tjDestroy(handle_);
}

bool Jpeg::takes(shm::Format format) { return turbo_format(format).has_value(); }

std::optional<std::span<const std::uint8_t>> Jpeg::encode(const shm::HeldFrame& frame) {
  const auto& head = frame.head();
  const auto format = turbo_format(static_cast<shm::Format>(head.format));
  if (!format || handle_ == nullptr || frame.data().size() < std::uint64_t{head.stride} * head.height) return std::nullopt;
  unsigned long size = capacity_;
  const int code = tjCompress2(handle_, reinterpret_cast<const unsigned char*>(frame.data().data()), static_cast<int>(head.width),
                               static_cast<int>(head.stride), static_cast<int>(head.height), *format, &buffer_, &size,
                               *format == TJPF_GRAY ? TJSAMP_GRAY : TJSAMP_420, quality, TJFLAG_FASTDCT);
  if (code != 0) return std::nullopt;
  capacity_ = std::max(capacity_, size);
  return std::span<const std::uint8_t>(buffer_, size);
}

}  // namespace channels
