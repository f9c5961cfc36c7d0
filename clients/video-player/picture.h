// An image as it came over a port, made ready to show: packed RGB, checked. Values; any thread.
#pragma once

#include <base/result.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <string>
#include <vector>

namespace video {

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> rgb;  // rows from top to bottom, 3 octets a pixel
};

// Formats: RGB8, BGR8, RGBA8, BGRA8, MONO8, MONO16 (its high octets), BAYER_RGGB8 and its like, DEPTH32F (shown as grey, near is bright),
// JPEG; images without a format by their bits per pixel (none: by their octets), "bitmap" the same with blue first.
// An image whose pixels do not fit its size is refused with a line that says what came and what was expected.
base::Result<Picture> to_picture(const RTC::CameraImage& image);
base::Result<void> write_png(const Picture& picture, const std::string& file);

}  // namespace video
