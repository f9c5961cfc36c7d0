#include "base/jpeg.h"

#include <turbojpeg.h>

#include <algorithm>
#include <climits>
#include <memory>

namespace base {

namespace {

constexpr std::uint64_t max_pixels = std::uint64_t{1} << 28;

int turbo_format(JpegPixels kind) {
  switch (kind) {
    case JpegPixels::rgb:
      return TJPF_RGB;
    case JpegPixels::bgr:
      return TJPF_BGR;
    case JpegPixels::rgba:
      return TJPF_RGBX;
    case JpegPixels::bgra:
      return TJPF_BGRX;
    case JpegPixels::grey:
      break;
  }
  return TJPF_GRAY;
}

// The decoder fills alpha with 255; the encoder must not read it.
int decoded_format(JpegPixels kind) {
  if (kind == JpegPixels::rgba) return TJPF_RGBA;
  if (kind == JpegPixels::bgra) return TJPF_BGRA;
  return turbo_format(kind);
}

}  // namespace

std::size_t bytes_per_pixel(JpegPixels kind) { return static_cast<std::size_t>(tjPixelSize[turbo_format(kind)]); }

JpegEncoder::JpegEncoder() : handle_(tjInitCompress()) {}

JpegEncoder::~JpegEncoder() {
  if (buffer_ != nullptr) tjFree(buffer_);
  if (handle_ != nullptr) tjDestroy(handle_);
}

Result<std::span<const std::uint8_t>> JpegEncoder::encode(std::span<const std::uint8_t> pixels, int width, int height, std::size_t stride,
                                                          JpegPixels kind, int quality) {
  if (handle_ == nullptr) return Error{"JPEG: the encoder cannot be created"};
  if (quality < 1 || quality > 100) return Error{"JPEG: quality must be from 1 to 100, got " + std::to_string(quality)};
  const auto row = bytes_per_pixel(kind) * static_cast<std::size_t>(std::max(width, 0));
  if (stride == 0) stride = row;
  if (width < 1 || height < 1 || stride < row || stride > INT_MAX || pixels.size() < stride * (static_cast<std::size_t>(height) - 1) + row)
    return Error{"JPEG: an image of " + std::to_string(width) + " x " + std::to_string(height) + " pixels does not fit into " +
                 std::to_string(pixels.size()) + " bytes"};
  unsigned long size = capacity_;
  const int format = turbo_format(kind);
  const int code = tjCompress2(handle_, pixels.data(), width, static_cast<int>(stride), height, format, &buffer_, &size,
                               format == TJPF_GRAY ? TJSAMP_GRAY : TJSAMP_420, quality, TJFLAG_FASTDCT);
  if (code != 0) return Error{std::string("JPEG: ") + tjGetErrorStr2(handle_)};
  capacity_ = std::max(capacity_, size);
  return std::span<const std::uint8_t>(buffer_, size);
}

Result<DecodedJpeg> decode_jpeg(std::span<const std::uint8_t> bytes, JpegPixels kind, int max_side) {
  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
  if (!decoder) return Error{"JPEG: the decoder cannot be created"};
  DecodedJpeg image;
  int sampling = 0, colours = 0;
  const auto size = static_cast<unsigned long>(bytes.size());
  if (size == 0 || tjDecompressHeader3(decoder.get(), bytes.data(), size, &image.width, &image.height, &sampling, &colours) != 0)
    return Error{size == 0 ? "JPEG: there is no data" : std::string("JPEG: ") + tjGetErrorStr2(decoder.get())};
  const auto pixels = static_cast<std::uint64_t>(std::max(image.width, 0)) * static_cast<std::uint64_t>(std::max(image.height, 0));
  if (pixels == 0 || image.width > max_side || image.height > max_side || pixels > max_pixels)
    return Error{"JPEG: an image of " + std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels, expected at most " +
                 std::to_string(max_side) + " a side and 2^28 in all"};
  image.pixels.resize(pixels * bytes_per_pixel(kind));
  if (tjDecompress2(decoder.get(), bytes.data(), size, image.pixels.data(), image.width, 0, image.height, decoded_format(kind), 0) != 0 &&
      tjGetErrorCode(decoder.get()) == TJERR_FATAL)
    return Error{std::string("JPEG: ") + tjGetErrorStr2(decoder.get())};
  return image;
}

}  // namespace base
