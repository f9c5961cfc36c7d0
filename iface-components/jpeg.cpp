#include "jpeg.h"

#include <turbojpeg.h>

#include <algorithm>
#include <string>

namespace iface {

namespace {

int turbo_format(JpegEncoder::Pixels kind) {
  switch (kind) {
    case JpegEncoder::Pixels::rgb:
      return TJPF_RGB;
    case JpegEncoder::Pixels::bgr:
      return TJPF_BGR;
    case JpegEncoder::Pixels::rgba:
      return TJPF_RGBX;
    case JpegEncoder::Pixels::bgra:
      return TJPF_BGRX;
    case JpegEncoder::Pixels::grey:
      break;
  }
  return TJPF_GRAY;
}

}  // namespace

JpegEncoder::JpegEncoder() : handle_(tjInitCompress()) {}

JpegEncoder::~JpegEncoder() {
  if (buffer_) tjFree(buffer_);
  if (handle_) tjDestroy(handle_);
}

base::Result<std::span<const unsigned char>> JpegEncoder::encode(std::span<const std::byte> pixels, int width, int height, Pixels kind,
                                                                 int quality) {
  const int format = turbo_format(kind);
  if (!handle_) return base::Error{"jpeg: the encoder cannot be made"};
  if (quality < 1 || quality > 100) return base::Error{"jpeg: quality must be from 1 to 100, got " + std::to_string(quality)};
  if (width < 1 || height < 1 ||
      pixels.size() < static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(tjPixelSize[format]))
    return base::Error{"jpeg: the image is smaller than its size says"};
  unsigned long size = capacity_;
  const int code = tjCompress2(handle_, reinterpret_cast<const unsigned char*>(pixels.data()), width, 0, height, format, &buffer_, &size,
                               format == TJPF_GRAY ? TJSAMP_GRAY : TJSAMP_420, quality, TJFLAG_FASTDCT);
  if (code != 0) return base::Error{std::string("jpeg: ") + tjGetErrorStr2(handle_)};
  capacity_ = std::max(capacity_, size);
  return std::span<const unsigned char>(buffer_, size);
}

}  // namespace iface
