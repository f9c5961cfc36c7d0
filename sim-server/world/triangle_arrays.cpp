#include "world/triangle_arrays.h"

#include <algorithm>

#include "reader/protocol.h"

namespace sim {

void put(ArrayWriter& out, const MeshShape& shape) {
  out.text(shape.submesh);
  out.number<std::uint64_t>(shape.center_submesh);
  for (int i = 0; i < 3; ++i) out.number(shape.scale[i]);
}

MeshShape take_shape(ArrayReader& in, const std::string& path) {
  MeshShape shape;
  shape.path = path;
  shape.submesh = in.text(max_request_bytes);
  shape.center_submesh = in.number<std::uint64_t>() != 0;
  for (int i = 0; i < 3; ++i) shape.scale[i] = in.number<double>();
  return shape;
}

void put(ArrayWriter& out, const TriangleMesh& mesh) {
  static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
  out.array(std::span(reinterpret_cast<const std::array<double, 3>*>(mesh.vertices.data()), mesh.vertices.size()));
  out.array(mesh.triangles);
}

bool take_triangles(ArrayReader& in, TriangleMesh& mesh) {
  const auto corners = in.array<std::array<double, 3>>(3 * max_triangles + max_triangles);
  mesh.triangles = in.array<std::array<std::uint32_t, 3>>(max_triangles);
  if (!in.ok() || mesh.triangles.empty()) return false;
  mesh.vertices.reserve(corners.size());
  for (const auto& corner : corners) {
    mesh.vertices.emplace_back(corner[0], corner[1], corner[2]);
    if (!mesh.vertices.back().allFinite() || mesh.vertices.back().cwiseAbs().maxCoeff() > largest_coordinate) return false;
  }
  const auto is_inside = [&](const auto& triangle) {
    return std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t corner) { return corner < mesh.vertices.size(); });
  };
  if (!std::all_of(mesh.triangles.begin(), mesh.triangles.end(), is_inside)) return false;
  return true;
}

void put(ArrayWriter& out, const HeightLevels& map) {
  out.number(map.columns);
  out.number(map.rows);
  out.number(map.lowest);
  out.number(map.highest);
  out.array(map.levels);
}

bool take_levels(ArrayReader& in, HeightLevels& map) {
  map.columns = in.number<std::uint32_t>();
  map.rows = in.number<std::uint32_t>();
  map.lowest = in.number<double>();
  map.highest = in.number<double>();
  constexpr std::uint64_t most = max_heights_a_side;
  map.levels = in.array<float>(most * most);
  const bool has_size = map.columns >= 2 && map.rows >= 2 && map.columns <= most && map.rows <= most;
  const bool has_range = map.lowest <= map.highest && std::max(-map.lowest, map.highest) <= largest_coordinate;
  if (!in.ok() || !has_size || !has_range || map.levels.size() != std::size_t{map.columns} * map.rows) return false;
  const auto low = static_cast<float>(map.lowest), high = static_cast<float>(map.highest);
  return std::all_of(map.levels.begin(), map.levels.end(), [&](float level) { return low <= level && level <= high; });
}

}  // namespace sim
