// Geometry before it reaches GL: triangles with normals and texture coordinates, and the materials of their parts. Values; any thread.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "reader/protocol.h"
#include "world/world_def.h"

namespace sim {

struct Vertex {
  std::array<float, 3> position;  // [m]
  std::array<float, 3> normal;    // unit
  std::array<float, 2> uv;        // v runs down the image
};

struct MeshPart {
  std::uint32_t first_index = 0;
  std::uint32_t index_count = 0;
  MaterialDef material;  // the file's own; plain grey for generated shapes
  // Told by finish():
  Eigen::AlignedBox3f bounds;  // of what the triangles use
  bool is_faceted = false;     // every triangle has one normal
};

// What the triangles of a round mesh stand for, in its axes: a capsule along z (a ball is one without length), or a cylinder.
enum class RoundKind { none, capsule, cylinder };
struct RoundShape {
  RoundKind kind = RoundKind::none;
  float radius = 0.5F, half_length = 0;  // half the way between the ends; of a capsule without them
};

// Three indices a triangle, counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<MeshPart> parts;
  Eigen::AlignedBox3f bounds;  // of what the triangles use
  RoundShape round;
  bool is_closed = false;    // seen from outside only: its back faces never show and are not needed for its shadow
  bool is_stand_in = false;  // for a mesh that could not be read; keeps its warning colour
};

// Fills in what follows from triangles and parts: bounds and facets.
void finish(Mesh& mesh);

// A picture inside a mesh file, by the name that the materials of the mesh use for it.
struct EmbeddedImage {
  std::string name;
  std::vector<std::uint8_t> bytes;  // a PNG or JPEG file
};

struct MeshFile {
  Mesh mesh;
  std::vector<EmbeddedImage> images;
  FileStamps files;  // that it was read from
};

// Unit shapes, to be scaled: a box, ellipsoid or cylinder of 1 x 1 x 1 m about the origin; a square of 1 m in the x-y plane.
Mesh make_box();
Mesh make_sphere(int rings = 18, int segments = 36);
Mesh make_cylinder(int segments = 40);
Mesh make_plane();
// Can't be scaled from a unit shape without losing its round ends.
Mesh make_capsule(double radius, double length, int rings = 18, int segments = 36);
// About the middle of its height, the tip above.
Mesh make_cone(double radius, double length, int segments = 40);
// A rectangular grid of heights: row 0 lies at +y, column 0 at -x, its middle at the origin.
Mesh make_height_grid(int columns, int rows, double width, double depth, std::span<const float> heights);
// Every triangle gets its own flat normal; u and v are metres along the sides.
Mesh make_flat(std::span<const Eigen::Vector3d> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

// COLLADA, STL, OBJ, PLY, glTF and FBX, read by a process of its own (reader/asset_reader.h): all parts, or the submesh (a node or a mesh
// of that name). The result is scaled and, when asked for, centred. `model_path`: where the pictures lie that it names by model://.
// What is unchanged is read once for all who ask.
base::Result<MeshFile> read_mesh_file(const MeshShape& shape, const ModelPath& model_path = {});

}  // namespace sim
