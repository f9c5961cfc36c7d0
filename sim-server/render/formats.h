// A drawn picture in the formats that cameras publish. Values; any thread.
#pragma once

#include <cstdint>
#include <span>

#include "world/pixel_format.h"

namespace sim {

// As many whole pixels as fit into both; `width` [pixel] matters for Bayer mosaics. 16-bit grey is the luminance times 257, low byte first,
// and keeps the fractions that 8 bits lose. float32 is not for colours: nothing is written.
void convert_rgba(std::span<const std::uint8_t> rgba, int width, PixelFormat format, std::span<std::uint8_t> out);

// Gaussian noise on what convert_rgba wrote: on each value, `mean` and `deviation` as shares of full scale (0..1); alpha stays.
void add_noise(std::uint64_t seed, double mean, double deviation, PixelFormat format, std::span<std::uint8_t> pixels);

}  // namespace sim
