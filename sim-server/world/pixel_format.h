// The image formats of SDF cameras. Values; any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace sim {

enum class PixelFormat {
  rgb8,
  bgr8,
  rgba8,
  bgra8,
  mono8,
  mono16,
  bayer_rggb8,  // the colours of the first two pixels of the first row, then of the second
  bayer_bggr8,
  bayer_gbrg8,
  bayer_grbg8,
  float32,  // of depth cameras
};

// Knows the names of SDF, Gazebo classic and gz ("R8G8B8", "RGB_INT8", ...), in any case.
std::optional<PixelFormat> parse_pixel_format(std::string_view name);

constexpr std::size_t bytes_per_pixel(PixelFormat format) {
  switch (format) {
    case PixelFormat::rgb8:
    case PixelFormat::bgr8:
      return 3;
    case PixelFormat::rgba8:
    case PixelFormat::bgra8:
    case PixelFormat::float32:
      return 4;
    case PixelFormat::mono16:
      return 2;
    default:
      return 1;
  }
}

}  // namespace sim
