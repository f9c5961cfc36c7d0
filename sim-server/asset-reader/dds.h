// DirectDraw surfaces, as games and OGRE keep textures: the largest level of the first picture, with block compression 1 to 3 (DXT1, DXT3,
// DXT5) or uncompressed. Any thread.
#pragma once

#include <cstdint>
#include <span>

#include "base/result.h"
#include "render/image.h"

namespace sim {

bool is_dds(std::span<const std::uint8_t> bytes);

base::Result<Image> decode_dds(std::span<const std::uint8_t> bytes);

}  // namespace sim
