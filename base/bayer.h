// Converts mosaics of colour filters (Bayer) to colour images. Functions; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace base {

// Where the first red pixel of a mosaic is: row and column, each 0 or 1; blue is diagonally beside it, green everywhere else.
struct BayerOrder {
  int red_row = 0;
  int red_column = 0;
};

// "rggb", "bggr", "gbrg", "grbg": the colours of the first two pixels of the first row, then of the second; small letters.
std::optional<BayerOrder> parse_bayer_order(std::string_view name);

// Each colour that a pixel does not have is the mean of its neighbours that do. `mosaic`: a byte per pixel, rows `stride` bytes apart;
// `rgb`: 3 * width * height bytes.
void demosaic(std::span<const std::uint8_t> mosaic, int width, int height, std::size_t stride, BayerOrder order,
              std::span<std::uint8_t> rgb);

}  // namespace base
