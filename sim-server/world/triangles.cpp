#include "world/triangles.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reader/asset_reader.h"
#include "world/triangle_arrays.h"

namespace sim {
namespace {

constexpr std::size_t max_corners = 5000;  // of all outlines of a polyline: joining and clipping them costs more than their square

using MeshShelf = AssetShelf<TriangleMesh>;
using LevelShelf = AssetShelf<HeightLevels>;
constexpr std::size_t max_kept = std::size_t{256} << 20U;  // [byte] of what nobody uses any more

MeshShelf& mesh_shelf() {
  static auto& shelf = *new MeshShelf(max_kept);  // never destroyed: as the reader
  return shelf;
}
LevelShelf& level_shelf() {
  static auto& shelf = *new LevelShelf(max_kept);
  return shelf;
}

MeshShelf::Found read_mesh(const MeshShape& shape) {
  ArrayWriter details;
  put(details, shape);
  return mesh_shelf().get(shape.path + '|' + details.bytes(), [&]() -> MeshShelf::Made {
    const AssetReader::Question question{AssetKind::triangles, shape.path, "mesh", details.bytes()};
    const auto answer = AssetReader::mine().ask(question);
    return {AssetReader::decoded<TriangleMesh>(question, answer, take_triangles), answer.files, answer.result.size(),
            !answer.files.empty()};
  });
}

LevelShelf::Found read_levels(const std::string& path) {
  return level_shelf().get(path, [&]() -> LevelShelf::Made {
    const AssetReader::Question question{AssetKind::heights, path, "height map", {}};
    const auto answer = AssetReader::mine().ask(question);
    return {AssetReader::decoded<HeightLevels>(question, answer, take_levels), answer.files, answer.result.size(), !answer.files.empty()};
  });
}

// --- polylines: ear clipping, holes joined to the outline by bridges

using Outline = std::vector<Eigen::Vector2d>;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double area(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) twice += cross(outline[i], outline[(i + 1) % outline.size()]);
  return twice / 2;
}

bool is_inside(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0;
}

bool segments_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

// Joins a hole (clockwise) to the outline (counter-clockwise) along the shortest line that crosses neither.
void join_hole(Outline& outline, const Outline& hole) {
  std::size_t best_outer = 0, best_inner = 0;
  double best = infinite;
  for (std::size_t o = 0; o < outline.size(); ++o) {
    for (std::size_t h = 0; h < hole.size(); ++h) {
      const double distance = (outline[o] - hole[h]).squaredNorm();
      if (distance >= best) continue;
      bool is_free = true;
      const auto check = [&](const Outline& ring) {
        for (std::size_t i = 0; i < ring.size() && is_free; ++i) {
          is_free = !segments_cross(outline[o], hole[h], ring[i], ring[(i + 1) % ring.size()]);
        }
      };
      check(outline);
      check(hole);
      if (is_free) best = distance, best_outer = o, best_inner = h;
    }
  }
  Outline joined(outline.begin(), outline.begin() + static_cast<long>(best_outer) + 1);
  for (std::size_t i = 0; i <= hole.size(); ++i) joined.push_back(hole[(best_inner + i) % hole.size()]);
  joined.insert(joined.end(), outline.begin() + static_cast<long>(best_outer), outline.end());
  outline = std::move(joined);
}

// Indexes into `outline`, which runs counter-clockwise.
std::vector<std::array<std::uint32_t, 3>> clip_ears(const Outline& outline) {
  std::vector<std::uint32_t> ring(outline.size());
  for (std::uint32_t i = 0; i < ring.size(); ++i) ring[i] = i;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  while (ring.size() >= 3) {
    const std::size_t n = ring.size();
    std::size_t ear = n;
    for (std::size_t i = 0; i < n && ear == n; ++i) {
      const auto a = ring[(i + n - 1) % n], b = ring[i], c = ring[(i + 1) % n];
      if (cross(outline[b] - outline[a], outline[c] - outline[b]) <= 0) continue;
      bool is_empty = true;
      for (const auto p : ring) {
        if (outline[p] == outline[a] || outline[p] == outline[b] || outline[p] == outline[c]) continue;
        if (is_inside(outline[p], outline[a], outline[b], outline[c])) {
          is_empty = false;
          break;
        }
      }
      if (is_empty) ear = i;
    }
    if (ear == n) {  // only flat corners are left, or the outline crosses itself: drop a corner and go on
      ring.erase(ring.begin());
      continue;
    }
    triangles.push_back({ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n]});
    ring.erase(ring.begin() + static_cast<long>(ear));
  }
  return triangles;
}

base::Result<TriangleMesh> polyline_triangles(const PolylineShape& shape) {
  std::size_t corners = 0;
  for (const Outline& ring : shape.outlines) corners += ring.size();
  if (corners > max_corners) return base::Error{fmt::format("polyline: has {} corners, at most {} are expected", corners, max_corners)};
  TriangleMesh mesh;
  Outline outline;
  const auto add_walls = [&](const Outline& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const auto& a = ring[i];
      const auto& b = ring[(i + 1) % ring.size()];
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.insert(mesh.vertices.end(),
                           {{a.x(), a.y(), 0}, {b.x(), b.y(), 0}, {b.x(), b.y(), shape.height}, {a.x(), a.y(), shape.height}});
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
    }
  };
  for (std::size_t i = 0; i < shape.outlines.size(); ++i) {
    Outline ring = shape.outlines[i];
    if (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
    if (ring.size() < 3) continue;
    const bool is_hole = !outline.empty();
    if ((area(ring) < 0) != is_hole) std::reverse(ring.begin(), ring.end());
    add_walls(ring);
    if (is_hole) {
      join_hole(outline, ring);
    } else {
      outline = std::move(ring);
    }
  }
  for (const auto& t : clip_ears(outline)) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const double z : {0.0, shape.height}) {
      for (const auto corner : t) mesh.vertices.emplace_back(outline[corner].x(), outline[corner].y(), z);
    }
    mesh.triangles.push_back({first, first + 2, first + 1});
    mesh.triangles.push_back({first + 3, first + 4, first + 5});
  }
  if (mesh.triangles.empty()) return base::Error{"polyline: no outline with three corners"};
  return mesh;
}

// --- height maps

base::Result<HeightGrid> read_heights(const HeightmapShape& shape) {
  const auto found = read_levels(shape.path);
  if (!found.value) return found.value.error();
  const HeightLevels& map = **found.value;
  HeightGrid grid{static_cast<int>(map.columns), static_cast<int>(map.rows), shape.size.x(), shape.size.y(), {}};
  grid.heights.reserve(map.levels.size());
  // The lowest elevation stays what it is, as in gz-sim; a picture's is 0.
  const double range = map.highest > map.lowest ? map.highest - map.lowest : 1;
  for (const float level : map.levels)
    grid.heights.push_back(static_cast<float>(map.lowest + (static_cast<double>(level) - map.lowest) / range * shape.size.z()));
  return grid;
}

TriangleMesh grid_triangles(const HeightGrid& grid, const Eigen::Vector3d& position) {
  TriangleMesh mesh;
  mesh.vertices.reserve(grid.heights.size());
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const double x = (static_cast<double>(column) / (grid.columns - 1) - 0.5) * grid.width;
      const double y = (0.5 - static_cast<double>(row) / (grid.rows - 1)) * grid.depth;
      const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column);
      mesh.vertices.push_back(Eigen::Vector3d(x, y, grid.heights[i]) + position);
    }
  }
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int column = 0; column + 1 < grid.columns; ++column) {
      const auto a = static_cast<std::uint32_t>(row * grid.columns + column), b = a + 1;
      const auto c = a + static_cast<std::uint32_t>(grid.columns), d = c + 1;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({b, c, d});
    }
  }
  return mesh;
}

std::string key_of(const GeometryDef& geometry) {
  if (const auto* mesh = std::get_if<MeshShape>(&geometry)) {
    return fmt::format("mesh|{}|{}|{}|{} {} {}|{}", mesh->path, mesh->submesh, mesh->center_submesh, mesh->scale.x(), mesh->scale.y(),
                       mesh->scale.z(), mesh->version);
  }
  if (const auto* map = std::get_if<HeightmapShape>(&geometry)) {
    return fmt::format("map|{}|{} {} {}|{} {} {}", map->path, map->size.x(), map->size.y(), map->size.z(), map->position.x(),
                       map->position.y(), map->position.z());
  }
  return {};
}

}  // namespace

TriangleMesh cone_triangles(const ConeShape& shape, int segments) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, shape.length / 2}, {0, 0, -shape.length / 2}};
  for (int s = 0; s < segments; ++s) {
    const double around = 2 * std::numbers::pi * s / segments;
    mesh.vertices.emplace_back(shape.radius * std::cos(around), shape.radius * std::sin(around), -shape.length / 2);
  }
  for (int s = 0; s < segments; ++s) {
    const auto a = static_cast<std::uint32_t>(2 + s), b = static_cast<std::uint32_t>(2 + (s + 1) % segments);
    mesh.triangles.push_back({0, a, b});
    mesh.triangles.push_back({1, b, a});
  }
  return mesh;
}

TriangleMesh ellipsoid_triangles(const Eigen::Vector3d& radii, int rings, int segments) {
  TriangleMesh mesh;
  const auto at = [&](int ring, int segment) {
    const double polar = std::numbers::pi * ring / rings, around = 2 * std::numbers::pi * segment / segments;
    return Eigen::Vector3d(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar))
        .cwiseProduct(radii)
        .eval();
  };
  mesh.vertices.push_back(at(0, 0));
  for (int ring = 1; ring < rings; ++ring) {
    for (int segment = 0; segment < segments; ++segment) mesh.vertices.push_back(at(ring, segment));
  }
  mesh.vertices.push_back(at(rings, 0));
  const auto index = [&](int ring, int segment) { return static_cast<std::uint32_t>(1 + (ring - 1) * segments + segment % segments); };
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (int s = 0; s < segments; ++s) {
    mesh.triangles.push_back({0, index(1, s), index(1, s + 1)});
    for (int ring = 1; ring + 1 < rings; ++ring) {
      mesh.triangles.push_back({index(ring, s), index(ring + 1, s), index(ring + 1, s + 1)});
      mesh.triangles.push_back({index(ring, s), index(ring + 1, s + 1), index(ring, s + 1)});
    }
    mesh.triangles.push_back({index(rings - 1, s), last, index(rings - 1, s + 1)});
  }
  return mesh;
}

base::Result<std::shared_ptr<const TriangleMesh>> TriangleCache::triangles(const GeometryDef& geometry) {
  const std::string key = key_of(geometry);
  if (const auto found = meshes_.find(key); !key.empty() && found != meshes_.end()) return found->second;
  if (const auto* shape = std::get_if<MeshShape>(&geometry)) {
    if (const auto known = faults_.find(key); known != faults_.end()) return known->second;
    auto found = read_mesh(*shape).value;
    if (found) meshes_[key] = *found;
    return found;
  }
  base::Result<TriangleMesh> mesh = base::Error{fmt::format("{}: has no triangles", kind_of(geometry))};
  if (const auto* shape = std::get_if<PolylineShape>(&geometry)) mesh = polyline_triangles(*shape);
  if (const auto* shape = std::get_if<EllipsoidShape>(&geometry)) mesh = ellipsoid_triangles(shape->radii);
  if (const auto* shape = std::get_if<ConeShape>(&geometry)) mesh = cone_triangles(*shape);
  if (const auto* shape = std::get_if<HeightmapShape>(&geometry)) {
    const auto grid = heights(*shape);
    if (!grid) return grid.error();
    mesh = grid_triangles(**grid, shape->position);
  }
  if (!mesh) return mesh.error();
  auto shared = std::make_shared<const TriangleMesh>(std::move(*mesh));
  if (!key.empty()) meshes_[key] = shared;
  return shared;
}

void TriangleCache::prepare(ModelDef& model) {
  const auto prepare_shape = [&](MeshShape& shape) {
    if (shape.path == missing_file) return;
    const auto found = read_mesh(shape);
    if (!found.files.empty()) shape.version = version_of(found.files);
    if (found.value) {
      meshes_[key_of(shape)] = *found.value;
    } else {
      faults_.insert_or_assign(key_of(shape), found.value.error());
    }
  };
  for (LinkDef& link : model.links) {
    for (CollisionDef& collision : link.collisions) {
      if (auto* shape = std::get_if<MeshShape>(&collision.geometry)) prepare_shape(*shape);
      if (auto* shape = std::get_if<HeightmapShape>(&collision.geometry)) (void)heights(*shape);
    }
  }
}

void TriangleCache::adopt(TriangleCache&& other) {
  for (auto& [key, mesh] : other.meshes_) meshes_.insert_or_assign(key, std::move(mesh));
  for (auto& [key, grid] : other.grids_) grids_.insert_or_assign(key, std::move(grid));
  for (auto& [key, fault] : other.faults_) faults_.insert_or_assign(key, std::move(fault));
}

base::Result<std::shared_ptr<const HeightGrid>> TriangleCache::heights(const HeightmapShape& shape) {
  const std::string key = key_of(shape);
  if (const auto found = grids_.find(key); found != grids_.end()) return found->second;
  auto grid = read_heights(shape);
  if (!grid) return grid.error();
  auto shared = std::make_shared<const HeightGrid>(std::move(*grid));
  grids_[key] = shared;
  return shared;
}

}  // namespace sim
