#include "world/triangles.h"

#include <png.h>
#include <spdlog/fmt/fmt.h>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>

#include "base/text.h"
#include "world/mesh_io.h"

namespace sim {
namespace {

constexpr std::size_t most_triangles = 20'000'000;
constexpr std::size_t most_corners = 5000;  // of all outlines of a polyline: joining and clipping them costs more than their square
constexpr int most_heights_a_side = 2049;   // what larger maps have between is left out: every height costs some 250 bytes

bool is_finite(const Eigen::Vector3d& v) { return v.allFinite() && v.cwiseAbs().maxCoeff() < 1e7; }

// Adds the meshes below `node` that the shape asks for.
void collect(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, const MeshShape& shape, bool inside, TriangleMesh& out) {
  const aiMatrix4x4 transform = parent * node.mTransformation;
  const bool wanted = inside || shape.submesh.empty() || shape.submesh == node.mName.C_Str();
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    if (!wanted && shape.submesh != mesh.mName.C_Str()) continue;
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = transform * mesh.mVertices[v];
      out.vertices.emplace_back(p.x, p.y, p.z);
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3 || out.triangles.size() >= most_triangles) continue;
      out.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    collect(scene, *node.mChildren[i], transform, shape, wanted && !shape.submesh.empty(), out);
}

void finish_mesh(const MeshShape& shape, TriangleMesh& mesh) {
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return !is_finite(mesh.vertices[t[0]]) || !is_finite(mesh.vertices[t[1]]) || !is_finite(mesh.vertices[t[2]]);
  });
  for (auto& vertex : mesh.vertices) {
    if (!is_finite(vertex)) vertex.setZero();
  }
  if (shape.center_submesh && !shape.submesh.empty() && !mesh.vertices.empty()) {
    Eigen::AlignedBox3d box;
    for (const auto& vertex : mesh.vertices) box.extend(vertex);
    for (auto& vertex : mesh.vertices) vertex -= box.center();
  }
  for (auto& vertex : mesh.vertices) vertex = vertex.cwiseProduct(shape.scale);
  if (shape.scale.prod() < 0) {  // mirrored: keep the outside outside
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
}

base::Result<TriangleMesh> read_mesh(const MeshShape& shape, bool by_id = false) {
  try {
    Assimp::Importer importer;
    importer.SetIOHandler(new MeshIo);  // the importer's from now on
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    // Gazebo finds submeshes by the names of their nodes, older worlds of ours by their ids.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, !shape.submesh.empty() && !by_id);
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                                            aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                                            aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS |
                                                            aiComponent_MATERIALS);
    const aiScene* scene =
        importer.ReadFile(shape.path, aiProcess_Triangulate | aiProcess_RemoveComponent | aiProcess_JoinIdenticalVertices |
                                          aiProcess_SortByPType | aiProcess_FindDegenerates);
    if (scene == nullptr || scene->mRootNode == nullptr) {
      return base::Error{fmt::format("mesh {}: {}", shape.path, import_fault(importer.GetErrorString()))};
    }
    TriangleMesh mesh;
    collect(*scene, *scene->mRootNode, aiMatrix4x4(), shape, false, mesh);
    if (mesh.triangles.empty() && !shape.submesh.empty() && !by_id) return read_mesh(shape, true);
    finish_mesh(shape, mesh);
    if (mesh.triangles.empty()) {
      return base::Error{shape.submesh.empty() ? fmt::format("mesh {}: has no triangle", shape.path)
                                               : fmt::format("mesh {}: has no submesh {}", shape.path, base::in_quotes(shape.submesh))};
    }
    return mesh;
  } catch (const std::bad_alloc&) {
    return base::Error{fmt::format("mesh {}: is too large for the memory", shape.path)};
  } catch (const std::exception& e) {
    return base::Error{fmt::format("mesh {}: {}", shape.path, base::in_quotes(e.what()))};
  }
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
  if (corners > most_corners) return base::Error{fmt::format("polyline: has {} corners, at most {} are expected", corners, most_corners)};
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

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

base::Result<HeightGrid> read_heights(const HeightmapShape& shape) {
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen(shape.path.c_str(), "rb"));
  if (!file) return base::Error{fmt::format("height map {}: cannot be opened", shape.path)};
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_stdio(&image, file.get()) == 0) {
    return base::Error{fmt::format("height map {}: {} (expected a PNG image)", shape.path, image.message)};
  }
  if (image.width < 2 || image.height < 2 || image.width > 8193 || image.height > 8193) {
    png_image_free(&image);
    return base::Error{fmt::format("height map {}: size {}x{} (expected 2..8193)", shape.path, image.width, image.height)};
  }
  // 16-bit images stay linear; 8-bit ones would pass a gamma curve in linear format.
  const bool is_deep = (image.format & PNG_FORMAT_FLAG_LINEAR) != 0;
  image.format = is_deep ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
  std::vector<std::uint16_t> deep(is_deep ? std::size_t{image.width} * image.height : 0);
  std::vector<std::uint8_t> flat(is_deep ? 0 : std::size_t{image.width} * image.height);
  if (png_image_finish_read(&image, nullptr, is_deep ? static_cast<void*>(deep.data()) : flat.data(), 0, nullptr) == 0) {
    return base::Error{fmt::format("height map {}: {}", shape.path, image.message)};
  }
  const auto kept = [](std::uint32_t side) { return std::min(static_cast<int>(side), most_heights_a_side); };
  HeightGrid grid{kept(image.width), kept(image.height), shape.size.x(), shape.size.y(), {}};
  grid.heights.reserve(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows));
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      // The corners stay where they are.
      const auto x = static_cast<std::size_t>(column) * (image.width - 1) / static_cast<std::size_t>(grid.columns - 1);
      const auto y = static_cast<std::size_t>(row) * (image.height - 1) / static_cast<std::size_t>(grid.rows - 1);
      const std::size_t i = y * image.width + x;
      const double level = is_deep ? deep[i] / 65535.0 : flat[i] / 255.0;
      grid.heights.push_back(static_cast<float>(level * shape.size.z()));
    }
  }
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
    return fmt::format("mesh|{}|{}|{}|{} {} {}", mesh->path, mesh->submesh, mesh->center_submesh, mesh->scale.x(), mesh->scale.y(),
                       mesh->scale.z());
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
  base::Result<TriangleMesh> mesh = base::Error{fmt::format("{}: has no triangles", kind_of(geometry))};
  if (const auto* shape = std::get_if<MeshShape>(&geometry)) mesh = read_mesh(*shape);
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
