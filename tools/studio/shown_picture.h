// Converts camera images to JPEG for a browser. Depth becomes grey: near is bright, the farthest pixel is dark. A colour filter mosaic is
// interpolated. Of 16-bit grey the upper eight bits are used. Functions; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/jpeg.h"
#include "base/result.h"

namespace studio {

// Rows from top to bottom. `encoding` as in sensor_msgs/msg/Image: "rgb8", "bgr8", "rgba8", "bgra8", "mono8", "mono16", "32FC1",
// "bayer_rggb8", ...
struct RawPicture {
  std::uint32_t width = 0, height = 0;
  std::size_t stride = 0;  // octets from row to row
  std::string_view encoding;
  std::string_view data;
};

// "depth:robot::eyes" is the one of this type, "robot::eyes" the camera, or else the depth camera, of this name.
struct CameraName {
  std::vector<std::string> types;  // in which it is looked for
  std::string iface;
};
CameraName camera_name(const std::string& text);

base::Result<std::string> jpeg_of(const RawPicture& picture, base::JpegEncoder& encoder);

// A message of this type in CDR with the low octet first, as recordings of ours have it: sensor_msgs/msg/CompressedImage or Image.
base::Result<std::string> jpeg_in_message(std::string_view type, std::string_view octets);

}  // namespace studio
