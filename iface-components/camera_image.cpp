#include "camera_image.h"

#include <base/bayer.h>
#include <base/text.h>

#include <cstring>
#include <string_view>

namespace iface {

ImageFormat image_format(shm::Format format) {
  switch (shm::shown_as(format)) {
    case shm::Format::rgb8:
      return {"RGB8", 24, Img::CF_RGB};
    case shm::Format::bgr8:
      return {"BGR8", 24, Img::CF_RGB};
    case shm::Format::rgba8:
      return {"RGBA8", 32, Img::RGBA};
    case shm::Format::bgra8:
      return {"BGRA8", 32, Img::RGBA};
    case shm::Format::mono8:
      return {"MONO8", 8, Img::CF_GRAY};
    case shm::Format::mono16:
      return {"MONO16", 16, Img::Y16};
    case shm::Format::bayer_rggb8:
      return {"BAYER_RGGB8", 8, Img::RAW};
    case shm::Format::bayer_bggr8:
      return {"BAYER_BGGR8", 8, Img::RAW};
    case shm::Format::bayer_gbrg8:
      return {"BAYER_GBRG8", 8, Img::RAW};
    case shm::Format::bayer_grbg8:
      return {"BAYER_GRBG8", 8, Img::RAW};
    default:
      return {"", 0, Img::CF_UNKNOWN};
  }
}

std::span<const std::byte> packed(const shm::FrameHead& head, std::span<const std::byte> data, std::vector<std::byte>& scratch) {
  const std::size_t row = std::size_t{head.width} * shm::bytes_per_pixel(static_cast<shm::Format>(head.format));
  if (head.stride == row || row == 0) return data.first(std::min(data.size(), row * head.height));
  scratch.resize(row * head.height);
  for (std::size_t y = 0; y < head.height && y * head.stride + row <= data.size(); ++y)
    std::memcpy(&scratch[y * row], &data[y * head.stride], row);
  return scratch;
}

std::span<const std::byte> for_img(shm::Format format, std::span<const std::byte> packed_pixels, std::vector<std::byte>& scratch) {
  if (format != shm::Format::bgr8 && format != shm::Format::bgra8) return packed_pixels;
  const std::size_t pixel = shm::bytes_per_pixel(format);
  scratch.assign(packed_pixels.begin(), packed_pixels.end());
  for (std::size_t i = 0; i + pixel <= scratch.size(); i += pixel) std::swap(scratch[i], scratch[i + 2]);
  return scratch;
}

base::Result<std::span<const std::uint8_t>> to_jpeg(base::JpegEncoder& encoder, const shm::FrameHead& head,
                                                    std::span<const std::byte> packed_pixels, int quality,
                                                    std::vector<std::byte>& scratch) {
  const auto format = static_cast<shm::Format>(head.format);
  const int width = static_cast<int>(head.width), height = static_cast<int>(head.height);
  const auto encode = [&](std::span<const std::byte> pixels, base::JpegPixels kind) {
    return encoder.encode({reinterpret_cast<const std::uint8_t*>(pixels.data()), pixels.size()}, width, height, 0, kind, quality);
  };
  switch (shm::shown_as(format)) {
    case shm::Format::rgb8:
      return encode(packed_pixels, base::JpegPixels::rgb);
    case shm::Format::bgr8:
      return encode(packed_pixels, base::JpegPixels::bgr);
    case shm::Format::rgba8:
      return encode(packed_pixels, base::JpegPixels::rgba);
    case shm::Format::bgra8:
      return encode(packed_pixels, base::JpegPixels::bgra);
    case shm::Format::mono8:
      return encode(packed_pixels, base::JpegPixels::grey);
    case shm::Format::mono16:
      scratch.resize(packed_pixels.size() / 2);
      for (std::size_t i = 0; i < scratch.size(); ++i) scratch[i] = packed_pixels[2 * i + 1];
      return encode(scratch, base::JpegPixels::grey);
    default:
      break;
  }
  const std::string_view name = image_format(format).name;
  const auto order = name.starts_with("BAYER_") ? base::parse_bayer_order(base::to_lower(name.substr(6, 4))) : std::nullopt;
  const std::size_t count = std::size_t{head.width} * head.height;
  if (!order || packed_pixels.size() < count) return base::Error{"jpeg: frames of this format cannot be encoded"};
  scratch.resize(3 * count);
  base::demosaic({reinterpret_cast<const std::uint8_t*>(packed_pixels.data()), count}, width, height, head.width, *order,
                 {reinterpret_cast<std::uint8_t*>(scratch.data()), scratch.size()});
  return encode(scratch, base::JpegPixels::rgb);
}

}  // namespace iface
