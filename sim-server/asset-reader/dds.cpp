#include "asset-reader/dds.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace sim {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Pixel = std::array<std::uint8_t, 4>;
using Block = std::array<Pixel, 16>;  // 4 x 4, row by row

constexpr std::uint32_t max_dds_side = 16384;
constexpr std::uint64_t max_pixels = std::uint64_t{1} << 27U;

std::uint32_t word_at(Bytes bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16) | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}
constexpr std::uint32_t code(const char (&text)[5]) {
  return static_cast<std::uint32_t>(static_cast<unsigned char>(text[0]) | static_cast<unsigned char>(text[1]) << 8 |
                                    static_cast<unsigned char>(text[2]) << 16) |
         static_cast<std::uint32_t>(static_cast<unsigned char>(text[3])) << 24;
}

enum class Packing { none, bc1, bc2, bc3 };

struct Layout {
  Packing packing = Packing::none;
  std::uint32_t bits = 32;                                                 // of a pixel that is not packed
  std::array<std::uint32_t, 4> masks{0xff, 0xff00, 0xff0000, 0xff000000};  // red, green, blue, alpha
};

base::Result<Layout> layout_of(Bytes bytes, std::size_t& data) {
  constexpr std::uint32_t has_code = 4, has_luminance = 0x20000;
  constexpr std::size_t extended_header = 20;
  const auto unknown = [&](const std::string& what) {
    return base::Error{"DDS of " + what + " is not read; DXT1, DXT3, DXT5 or no compression is expected"};
  };
  const std::uint32_t flags = word_at(bytes, 80), format = word_at(bytes, 84);
  if ((flags & has_code) != 0 && format == code("DX10")) {
    if (bytes.size() < data + extended_header) return base::Error{"is cut short"};
    const std::uint32_t number = word_at(bytes, data);
    data += extended_header;
    if (number >= 70 && number <= 72) return Layout{Packing::bc1, 0, {}};
    if (number >= 73 && number <= 75) return Layout{Packing::bc2, 0, {}};
    if (number >= 76 && number <= 78) return Layout{Packing::bc3, 0, {}};
    if (number >= 27 && number <= 29) return Layout{};
    if (number == 87 || number == 91) return Layout{Packing::none, 32, {0xff0000, 0xff00, 0xff, 0xff000000}};
    return unknown("format " + std::to_string(number));
  }
  if ((flags & has_code) != 0) {
    if (format == code("DXT1")) return Layout{Packing::bc1, 0, {}};
    if (format == code("DXT2") || format == code("DXT3")) return Layout{Packing::bc2, 0, {}};
    if (format == code("DXT4") || format == code("DXT5")) return Layout{Packing::bc3, 0, {}};
    std::string text(4, ' ');
    for (std::size_t i = 0; i < 4; ++i) text[i] = bytes[84 + i] >= 32 && bytes[84 + i] < 127 ? static_cast<char>(bytes[84 + i]) : '?';
    return unknown("format " + text);
  }
  Layout layout{Packing::none, word_at(bytes, 88), {word_at(bytes, 92), word_at(bytes, 96), word_at(bytes, 100), word_at(bytes, 104)}};
  if ((flags & has_luminance) != 0) layout.masks[1] = layout.masks[2] = layout.masks[0];
  if ((flags & 3U) == 0) layout.masks[3] = 0;
  if (layout.bits != 8 && layout.bits != 16 && layout.bits != 24 && layout.bits != 32)
    return unknown(std::to_string(layout.bits) + " bits a pixel");
  return layout;
}

Pixel from_565(std::uint32_t c) {
  const auto wide = [](std::uint32_t value, std::uint32_t most) { return static_cast<std::uint8_t>((value * 255 + most / 2) / most); };
  return {wide(c >> 11U & 31U, 31), wide(c >> 5U & 63U, 63), wide(c & 31U, 31), 255};
}

// (a * first + b * second) / (a + b), each component.
Pixel mix(const Pixel& first, const Pixel& second, int a, int b) {
  Pixel out{};
  for (std::size_t i = 0; i < 4; ++i) out[i] = static_cast<std::uint8_t>((a * first[i] + b * second[i] + (a + b) / 2) / (a + b));
  return out;
}

// `may_have_holes`: the one of the four colours that lets light through, in blocks without an alpha of their own.
void read_colors(Bytes bytes, bool may_have_holes, Block& block) {
  const std::uint32_t first = bytes[0] | bytes[1] << 8U, second = bytes[2] | bytes[3] << 8U;
  std::array<Pixel, 4> palette{from_565(first), from_565(second), {}, {}};
  if (first > second || !may_have_holes) {
    palette[2] = mix(palette[0], palette[1], 2, 1);
    palette[3] = mix(palette[0], palette[1], 1, 2);
  } else {
    palette[2] = mix(palette[0], palette[1], 1, 1);
  }
  const std::uint32_t indices = word_at(bytes, 4);
  for (std::size_t i = 0; i < 16; ++i) block[i] = palette[indices >> (2 * i) & 3U];
}

void read_plain_alpha(Bytes bytes, Block& block) {
  for (std::size_t i = 0; i < 16; ++i) block[i][3] = static_cast<std::uint8_t>((bytes[i / 2] >> (4 * (i % 2)) & 15) * 17);
}

void read_mixed_alpha(Bytes bytes, Block& block) {
  const int first = bytes[0], second = bytes[1];
  std::array<int, 8> palette{first, second, 0, 0, 0, 0, 0, 255};
  const int steps = first > second ? 7 : 5;
  for (int i = 1; i < steps; ++i) palette[static_cast<std::size_t>(i + 1)] = ((steps - i) * first + i * second + steps / 2) / steps;
  std::uint64_t indices = 0;
  for (std::size_t i = 0; i < 6; ++i) indices |= static_cast<std::uint64_t>(bytes[2 + i]) << (8 * i);
  for (std::size_t i = 0; i < 16; ++i) block[i][3] = static_cast<std::uint8_t>(palette[indices >> (3 * i) & 7U]);
}

void unpack(Bytes bytes, Packing packing, Image& image) {
  const std::size_t block_bytes = packing == Packing::bc1 ? 8 : 16;
  const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
  const std::size_t across = (width + 3) / 4;
  Block block;
  for (std::size_t row = 0; row < (height + 3) / 4; ++row) {
    for (std::size_t column = 0; column < across; ++column) {
      const Bytes packed = bytes.subspan((row * across + column) * block_bytes, block_bytes);
      read_colors(packed.last(8), packing == Packing::bc1, block);
      if (packing == Packing::bc2) read_plain_alpha(packed, block);
      if (packing == Packing::bc3) read_mixed_alpha(packed, block);
      for (std::size_t i = 0; i < 16; ++i) {
        const std::size_t x = column * 4 + i % 4, y = row * 4 + i / 4;
        if (x < width && y < height) std::copy(block[i].begin(), block[i].end(), &image.rgba[(y * width + x) * 4]);
      }
    }
  }
}

std::uint8_t masked(std::uint32_t pixel, std::uint32_t mask, std::uint8_t otherwise) {
  if (mask == 0) return otherwise;
  const int shift = std::countr_zero(mask);
  const std::uint64_t most = mask >> shift;
  return static_cast<std::uint8_t>(((pixel & mask) >> shift) * std::uint64_t{255} / most);
}

void read_plain(Bytes bytes, const Layout& layout, Image& image) {
  const std::size_t step = layout.bits / 8;
  for (std::size_t i = 0; i < image.rgba.size() / 4; ++i) {
    std::uint32_t pixel = 0;
    for (std::size_t b = 0; b < step; ++b) pixel |= static_cast<std::uint32_t>(bytes[i * step + b]) << (8 * b);
    for (std::size_t c = 0; c < 4; ++c) image.rgba[i * 4 + c] = masked(pixel, layout.masks[c], c == 3 ? 255 : 0);
  }
}

}  // namespace

bool is_dds(Bytes bytes) { return bytes.size() > 4 && std::memcmp(bytes.data(), "DDS ", 4) == 0; }

base::Result<Image> decode_dds(Bytes bytes) {
  std::size_t data = 128;
  if (bytes.size() < data) return base::Error{"is cut short"};
  const std::uint32_t height = word_at(bytes, 12), width = word_at(bytes, 16);
  if (width < 1 || height < 1 || width > max_dds_side || height > max_dds_side || std::uint64_t{width} * height > max_pixels)
    return base::Error{"must have from 1 to 16384 pixels a side and 2^27 in all, got " + std::to_string(width) + " x " +
                       std::to_string(height)};
  const auto layout = layout_of(bytes, data);
  if (!layout) return layout.error();
  const std::uint64_t blocks = std::uint64_t{(width + 3) / 4} * ((height + 3) / 4);
  const std::uint64_t needed = (*layout).packing == Packing::none  ? std::uint64_t{width} * height * ((*layout).bits / 8)
                               : (*layout).packing == Packing::bc1 ? blocks * 8
                                                                   : blocks * 16;
  if (bytes.size() - data < needed) return base::Error{"is cut short"};
  Image image{static_cast<int>(width), static_cast<int>(height), {}};
  image.rgba.resize(image.size_bytes());
  if ((*layout).packing == Packing::none) {
    read_plain(bytes.subspan(data), *layout, image);
  } else {
    unpack(bytes.subspan(data), (*layout).packing, image);
  }
  return image;
}

}  // namespace sim
