// Pictures in memory and in files: PNG (read, write), JPEG and DDS (read). What is read is read by a process of its own
// (reader/asset_reader.h). Values; any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "base/result.h"
#include "reader/protocol.h"

namespace sim {

// Rows from the top down, no padding, 4 bytes a pixel: red, green, blue (sRGB), alpha.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;

  std::size_t size_bytes() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4; }
};

// The kind is told from the first bytes. At most 16384 pixels a side; one of more than `largest_side` is halved until it has no more.
// `files` (may be null): what the picture depends on.
base::Result<Image> read_image(const std::filesystem::path& file, int largest_side = 16384, FileStamps* files = nullptr);
base::Result<Image> decode_image(std::span<const std::uint8_t> bytes, const std::string& name, int largest_side = 16384);

// A PNG: RGB when every pixel is opaque, otherwise RGBA.
base::Result<std::vector<std::uint8_t>> encode_png(const Image& image, const std::string& name = "in memory");  // name: for messages

// Writes RGB when every pixel is opaque, otherwise RGBA; the file appears complete or not at all.
base::Result<void> write_png(const Image& image, const std::filesystem::path& file);

// The mean of each 2 x 2 block, taken in linear light and weighted by alpha. Odd sizes lose their last row or column; 1 stays 1.
Image halve(const Image& image);

// sRGB transfer functions of one component, 0..1.
float to_linear(float srgb);
float to_srgb(float linear);

}  // namespace sim
