// Meshes, skins, animations and pictures as they cross from the reader of files (reader/protocol.h), and their checks. Values; any thread.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "reader/arrays.h"
#include "render/image.h"
#include "render/mesh.h"
#include "render/skin.h"

namespace sim {

inline constexpr std::size_t max_bones = 4096;
inline constexpr int largest_image = 16384;  // [pixel] a side

// `skin`: null for a mesh alone. Textures have the names that the file has for them; those inside the file are among the images.
void put(ArrayWriter& out, const MeshFile& file, const Skin* skin);
// False when an index is out of range, a number that is used is not finite, or a size does not fit. Bounds and facets are not filled in.
bool take(ArrayReader& in, MeshFile& file, Skin* skin);

// Positions in units of the file; nodes by their names.
struct RawTrack {
  std::string node;
  std::vector<double> position_times, rotation_times;  // [s]; as the file has them
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<float, 4>> rotations;  // w x y z
};
void put(ArrayWriter& out, const std::vector<RawTrack>& tracks);
bool take_tracks(ArrayReader& in, std::vector<RawTrack>& tracks);

void put(ArrayWriter& out, const Image& image);
bool take_image(ArrayReader& in, Image& image);

}  // namespace sim
