// Smaller copies of pictures, and the transfer functions of sRGB.
#include <algorithm>
#include <array>
#include <cmath>

#include "render/image.h"

namespace sim {
namespace {

struct LinearTable {
  std::array<float, 256> value;
  LinearTable() {
    for (int i = 0; i < 256; ++i) value[static_cast<std::size_t>(i)] = to_linear(static_cast<float>(i) / 255.0F);
  }
};

std::uint8_t to_byte(float srgb) { return static_cast<std::uint8_t>(std::clamp(srgb, 0.0F, 1.0F) * 255.0F + 0.5F); }

// The nearest sRGB code of a linear value, by table: fine enough that no code is missed.
struct SrgbTable {
  static constexpr int size = 1 << 14;
  std::vector<std::uint8_t> value = std::vector<std::uint8_t>(size + 1);
  SrgbTable() {
    for (int i = 0; i <= size; ++i) value[static_cast<std::size_t>(i)] = to_byte(to_srgb(static_cast<float>(i) / size));
  }
};

}  // namespace

float to_linear(float srgb) { return srgb <= 0.04045F ? srgb / 12.92F : std::pow((srgb + 0.055F) / 1.055F, 2.4F); }
float to_srgb(float linear) { return linear <= 0.0031308F ? linear * 12.92F : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F; }

Image halve(const Image& image) {
  static const LinearTable linear;
  static const SrgbTable srgb;
  const Image& in = image;
  Image out{std::max(1, in.width / 2), std::max(1, in.height / 2), {}};
  out.rgba.resize(out.size_bytes());
  const int step_x = in.width > 1 ? 1 : 0;
  const int step_y = in.height > 1 ? 1 : 0;
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const int x0 = in.width > 1 ? 2 * x : 0;
      const int y0 = in.height > 1 ? 2 * y : 0;
      float sum[3] = {0, 0, 0};
      float weight = 0;
      int alpha = 0;
      for (int k = 0; k < 4; ++k) {
        const auto row = static_cast<std::size_t>(y0 + (k >> 1) * step_y);
        const std::uint8_t* p = &in.rgba[(row * static_cast<std::size_t>(in.width) + static_cast<std::size_t>(x0 + (k & 1) * step_x)) * 4];
        const float w = static_cast<float>(p[3]) + 1e-3F;
        for (int c = 0; c < 3; ++c) sum[c] += w * linear.value[p[c]];
        weight += w;
        alpha += p[3];
      }
      std::uint8_t* p = &out.rgba[(static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width) + static_cast<std::size_t>(x)) * 4];
      for (int c = 0; c < 3; ++c) p[c] = srgb.value[static_cast<std::size_t>(sum[c] / weight * static_cast<float>(SrgbTable::size) + 0.5F)];
      p[3] = static_cast<std::uint8_t>((alpha + 2) / 4);
    }
  }
  return out;
}

}  // namespace sim
