// Triangles and heights as they cross from the reader of files (reader/protocol.h), and their checks. Values; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reader/arrays.h"
#include "world/triangles.h"

namespace sim {

inline constexpr std::size_t max_triangles = 20'000'000;
inline constexpr double largest_coordinate = 1e7;  // [m]
inline constexpr int largest_height_map = 8193;    // [pixel] a side
inline constexpr int max_heights_a_side = 2049;    // what larger maps have between is left out: every height costs some 250 bytes

void put(ArrayWriter& out, const MeshShape& shape);
MeshShape take_shape(ArrayReader& in, const std::string& path);

void put(ArrayWriter& out, const TriangleMesh& mesh);
// False when an index is out of range, a corner is not finite or too far away, or there is no triangle.
bool take_triangles(ArrayReader& in, TriangleMesh& mesh);

// What a file says of heights, before it has a size: levels of grey, or elevations [m].
struct HeightLevels {
  std::uint32_t columns = 0, rows = 0;
  double lowest = 0, highest = 255;  // that can be (black and white of a picture), or that the file has
  std::vector<float> levels;         // row by row; between them
};
void put(ArrayWriter& out, const HeightLevels& map);
bool take_levels(ArrayReader& in, HeightLevels& map);

}  // namespace sim
