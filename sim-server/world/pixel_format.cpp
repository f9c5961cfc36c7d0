#include "world/pixel_format.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/text.h"

namespace sim {

std::optional<PixelFormat> parse_pixel_format(std::string_view name) {
  using enum PixelFormat;
  static constexpr auto names = std::to_array<std::pair<std::string_view, PixelFormat>>({
      {"r8g8b8", rgb8},
      {"rgb_int8", rgb8},
      {"rgb8", rgb8},
      {"b8g8r8", bgr8},
      {"bgr_int8", bgr8},
      {"bgr8", bgr8},
      {"rgba_int8", rgba8},
      {"r8g8b8a8", rgba8},
      {"bgra_int8", bgra8},
      {"b8g8r8a8", bgra8},
      {"l8", mono8},
      {"l_int8", mono8},
      {"mono8", mono8},
      {"intensity8", mono8},
      {"l16", mono16},
      {"l_int16", mono16},
      {"mono16", mono16},
      {"bayer_rggb8", bayer_rggb8},
      {"bayer_bggr8", bayer_bggr8},
      {"bayer_rggr8", bayer_bggr8},  // a slip of the pen in SDF files that Gazebo classic accepted
      {"bayer_gbrg8", bayer_gbrg8},
      {"bayer_grbg8", bayer_grbg8},
      {"r_float32", float32},
      {"float32", float32},
  });
  const auto wanted = base::to_lower(name);
  const auto* found = std::find_if(names.begin(), names.end(), [&](const auto& entry) { return entry.first == wanted; });
  return found == names.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace sim
