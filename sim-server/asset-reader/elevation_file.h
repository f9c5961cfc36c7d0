// Elevations from TIFF files (GeoTIFF), by libtiff: one band of whole or floating-point numbers, in strips or tiles. They are taken as they
// stand, as if in metres; where the map lies on the Earth does not matter. A map that is not square lies in the north-west of a square one,
// whose rest has the lowest elevation, as in gz-sim. So has what the file marks as without a value (GDAL_NODATA, or -9999 or -32768 where
// that is missing) and what is no number. Errors are the reason alone. One thread at a time.
#pragma once

#include <cstdint>
#include <span>

#include "base/result.h"
#include "world/triangle_arrays.h"

namespace sim {

bool is_tiff(std::span<const std::uint8_t> bytes);

base::Result<HeightLevels> decode_elevations(std::span<const std::uint8_t> bytes);

}  // namespace sim
