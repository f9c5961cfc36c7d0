#include "render/formats.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "render/pixels.h"

namespace sim {
namespace {

// Offset in a pixel of the colour that a mosaic keeps, by row and column modulo 2.
using Mosaic = std::array<std::array<std::size_t, 2>, 2>;

Mosaic mosaic_of(PixelFormat format) {
  switch (format) {
    case PixelFormat::bayer_bggr8:
      return {{{2, 1}, {1, 0}}};
    case PixelFormat::bayer_gbrg8:
      return {{{1, 2}, {0, 1}}};
    case PixelFormat::bayer_grbg8:
      return {{{1, 0}, {2, 1}}};
    default:
      return {{{0, 1}, {1, 2}}};
  }
}

void to_mosaic(std::span<const std::uint8_t> rgba, std::size_t width, const Mosaic& mosaic, std::span<std::uint8_t> out) {
  const std::size_t pixels = std::min(rgba.size() / 4, out.size());
  for (std::size_t first = 0, row = 0; first < pixels; first += width, ++row) {
    const auto& offsets = mosaic[row % 2];
    const std::size_t end = std::min(first + width, pixels);
    for (std::size_t i = first; i < end; ++i) out[i] = rgba[4 * i + offsets[(i - first) % 2]];
  }
}

void to_bgr(std::span<const std::uint8_t> rgba, std::span<std::uint8_t> out) {
  const std::size_t pixels = std::min(rgba.size() / 4, out.size() / 3);
  rgba_to_rgb(rgba, out);
  for (std::size_t i = 0; i < pixels; ++i) std::swap(out[3 * i], out[3 * i + 2]);
}

void to_four(std::span<const std::uint8_t> rgba, std::size_t first, std::span<std::uint8_t> out) {
  const std::size_t pixels = std::min(rgba.size(), out.size()) / 4;
  for (std::size_t i = 0; i < pixels; ++i) {
    out[4 * i] = rgba[4 * i + first];
    out[4 * i + 1] = rgba[4 * i + 1];
    out[4 * i + 2] = rgba[4 * i + 2 - first];
    out[4 * i + 3] = 255;
  }
}

void put16(std::uint8_t* out, std::uint32_t value) {
  out[0] = static_cast<std::uint8_t>(value);
  out[1] = static_cast<std::uint8_t>(value >> 8);
}

void to_mono16(std::span<const std::uint8_t> rgba, std::span<std::uint8_t> out) {
  const std::size_t pixels = std::min(rgba.size() / 4, out.size() / 2);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint64_t sum = 19595ULL * rgba[4 * i] + 38470ULL * rgba[4 * i + 1] + 7471ULL * rgba[4 * i + 2];
    put16(&out[2 * i], static_cast<std::uint32_t>((sum * 257 + 32768) >> 16));
  }
}

}  // namespace

void convert_rgba(std::span<const std::uint8_t> rgba, int width, PixelFormat format, std::span<std::uint8_t> out) {
  switch (format) {
    case PixelFormat::rgb8:
      return rgba_to_rgb(rgba, out);
    case PixelFormat::bgr8:
      return to_bgr(rgba, out);
    case PixelFormat::rgba8:
      return to_four(rgba, 0, out);
    case PixelFormat::bgra8:
      return to_four(rgba, 2, out);
    case PixelFormat::mono8:
      return rgba_to_mono(rgba, out);
    case PixelFormat::mono16:
      return to_mono16(rgba, out);
    case PixelFormat::float32:
      return;
    default:
      return to_mosaic(rgba, static_cast<std::size_t>(width), mosaic_of(format), out);
  }
}

void add_noise(std::uint64_t seed, double mean, double deviation, PixelFormat format, std::span<std::uint8_t> pixels) {
  NoiseStream noise(seed);
  if (format == PixelFormat::mono16) return noise.add16(pixels, mean, deviation);
  noise.add(pixels, mean, deviation);
  if (format != PixelFormat::rgba8 && format != PixelFormat::bgra8) return;
  for (std::size_t i = 3; i < pixels.size(); i += 4) pixels[i] = 255;
}

}  // namespace sim
