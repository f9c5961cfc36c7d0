// Exports recorded camera images as PNG files. One thread at a time.
#pragma once

#include <optional>
#include <string>

#include "base/result.h"
#include "recording/sample_text.h"

namespace recorder {

// Rows from top to bottom; 1 or 3 or 4 octets a pixel, or 2 of grey with the low one first.
struct Picture {
  enum class Kind { grey, rgb, bgr, rgba, bgra, wide_grey } kind = Kind::rgb;
  std::uint32_t width = 0, height = 0;
  std::size_t stride = 0;  // octets from row to row
  std::string pixels;
};

// The types that have pictures: sensor_msgs/msg/Image and CompressedImage (JPEG), RTC::CameraImage.
bool has_pictures(const std::string& type);
// Of a sample of such a type. An error that says what its pictures are, when they are no pictures for people (depth, mosaics).
base::Result<Picture> picture_of(const std::string& type, const Json& sample);
base::Result<void> write_png(const Picture& picture, const std::string& file);

}  // namespace recorder
