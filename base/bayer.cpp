#include "base/bayer.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace base {

std::optional<BayerOrder> parse_bayer_order(std::string_view name) {
  if (name == "rggb") return BayerOrder{0, 0};
  if (name == "grbg") return BayerOrder{0, 1};
  if (name == "gbrg") return BayerOrder{1, 0};
  if (name == "bggr") return BayerOrder{1, 1};
  return std::nullopt;
}

void demosaic(std::span<const std::uint8_t> mosaic, int width, int height, std::size_t stride, BayerOrder order,
              std::span<std::uint8_t> rgb) {
  if (width <= 0 || height <= 0) return;
  const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
  assert(stride >= columns && mosaic.size() >= (rows - 1) * stride + columns && rgb.size() >= 3 * columns * rows);
  const auto color_at = [&](std::size_t row, std::size_t column) -> std::size_t {
    const bool in_red_row = row % 2 == static_cast<std::size_t>(order.red_row);
    const bool in_red_column = column % 2 == static_cast<std::size_t>(order.red_column);
    return in_red_row != in_red_column ? 1 : in_red_row ? 0 : 2;
  };
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      std::array<unsigned, 3> sum{}, count{};
      for (std::size_t y = row - (row > 0 ? 1 : 0); y <= std::min(row + 1, rows - 1); ++y) {
        for (std::size_t x = column - (column > 0 ? 1 : 0); x <= std::min(column + 1, columns - 1); ++x) {
          const std::size_t color = color_at(y, x);
          sum[color] += mosaic[y * stride + x];
          ++count[color];
        }
      }
      const std::size_t own = color_at(row, column);
      std::uint8_t* pixel = &rgb[3 * (row * columns + column)];
      for (std::size_t c = 0; c < 3; ++c)
        pixel[c] = c == own       ? mosaic[row * stride + column]
                   : count[c] > 0 ? static_cast<std::uint8_t>((sum[c] + count[c] / 2) / count[c])
                                  : std::uint8_t{0};
    }
  }
}

}  // namespace base
