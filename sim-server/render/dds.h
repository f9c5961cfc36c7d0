// DirectDraw surfaces, as games and OGRE keep textures: the largest level of the first picture, with block compression 1 to 3 (DXT1, DXT3,
// DXT5) or uncompressed. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"
#include "render/image.h"

namespace sim {

bool is_dds(std::span<const std::uint8_t> bytes);

// `name` stands for the file in messages.
base::Result<Image> decode_dds(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace sim
