// A received image, checked and converted to packed RGB for the window. Values; any thread.
#pragma once

#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace video {

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<unsigned char> rgb;  // rows from top to bottom, 3 octets a pixel
};

// Formats: RGB8, BGR8, RGBA8, BGRA8, MONO8, MONO16 (its high octets), BAYER_RGGB8 and its like, DEPTH32F (shown as grey, near is bright),
// JPEG; images without a format by their bits per pixel (none: by their octets), "bitmap" the same with blue first.
// Nothing if the pixels of an image do not fit its size; `problem` is then a line that says what came and what was expected.
std::optional<Picture> to_picture(const RTC::CameraImage& image, std::string& problem);
// Why it failed; empty when the file is written.
std::string write_png(const Picture& picture, const std::string& file);

// For lines of text: what a peer or a user wrote, with a ? for everything that a terminal would obey.
std::string quoted(std::string_view text);

}  // namespace video
