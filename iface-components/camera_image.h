// Converts frames of camera ifaces to the formats of the image types of ports, and to JPEG. Values; any thread.
#pragma once

#include <base/jpeg.h>
#include <base/result.h>
#include <rtm/ext/CameraCommonInterfaceSkel.h>
#include <shm/client.h>

#include <cstddef>
#include <span>
#include <vector>

namespace iface {

struct ImageFormat {
  const char* name;      // in RTC::CameraImage: RGB8, BGR8, RGBA8, BGRA8, MONO8, MONO16, BAYER_RGGB8, ...
  unsigned short bits;   // of a pixel
  Img::ColorFormat img;  // CF_RGB, RGBA, CF_GRAY, Y16, RAW (Bayer)
};

// Of colour frames; CF_UNKNOWN for others.
ImageFormat image_format(shm::Format format);

// Pixels in rows without gaps, as ports carry them: the frame's own, or `scratch` when its rows are padded.
std::span<const std::byte> packed(const shm::FrameHead& head, std::span<const std::byte> data, std::vector<std::byte>& scratch);

// What Img::ColorFormat can name: BGR as RGB and BGRA as RGBA in `scratch`, all others as they are.
std::span<const std::byte> for_img(shm::Format format, std::span<const std::byte> packed_pixels, std::vector<std::byte>& scratch);

// 16-bit grey by its high bytes, mosaics as the colours that they stand for.
base::Result<std::span<const std::uint8_t>> to_jpeg(base::JpegEncoder& encoder, const shm::FrameHead& head,
                                                    std::span<const std::byte> packed_pixels, int quality, std::vector<std::byte>& scratch);

}  // namespace iface
