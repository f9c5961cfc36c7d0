#include "render/mesh_arrays.h"

#include <algorithm>
#include <cmath>

#include "reader/protocol.h"

namespace sim {
namespace {

constexpr std::uint64_t max_vertices = 80'000'000, max_indices = 60'000'000, max_parts = 100'000, max_images = 10'000,
                        max_nodes = 1'000'000, max_keys = 50'000'000;
constexpr std::uint64_t max_name = 65536;

struct PlainMaterial {
  Color ambient, diffuse, specular, emissive;
  float shininess, metalness, roughness;
  std::uint32_t has_pbr, double_sided, has_alpha_texture;
};

using Matrix = std::array<double, 16>;

void put(ArrayWriter& out, const MaterialDef& m) {
  out.number(PlainMaterial{m.ambient, m.diffuse, m.specular, m.emissive, m.shininess, m.metalness, m.roughness, m.has_pbr, m.double_sided,
                           m.has_alpha_texture});
  out.text(m.texture);
}

// What is no number becomes what a material has that says nothing.
float number_or(float value, float otherwise) { return std::isfinite(value) ? value : otherwise; }
Color color_or(const Color& c, const Color& otherwise) {
  return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b) && std::isfinite(c.a) ? c : otherwise;
}

MaterialDef take_material(ArrayReader& in) {
  const auto m = in.number<PlainMaterial>();
  const MaterialDef usual;
  MaterialDef out;
  out.ambient = color_or(m.ambient, usual.ambient);
  out.diffuse = color_or(m.diffuse, usual.diffuse);
  out.specular = color_or(m.specular, usual.specular);
  out.emissive = color_or(m.emissive, usual.emissive);
  out.shininess = number_or(m.shininess, usual.shininess);
  out.metalness = number_or(m.metalness, usual.metalness);
  out.roughness = number_or(m.roughness, usual.roughness);
  out.has_pbr = m.has_pbr != 0;
  out.double_sided = m.double_sided != 0;
  out.has_alpha_texture = m.has_alpha_texture != 0;
  out.texture = in.text(max_name);
  return out;
}

void put(ArrayWriter& out, const Eigen::Affine3d& pose) {
  Matrix numbers;
  std::copy_n(pose.matrix().data(), 16, numbers.begin());
  out.number(numbers);
}

Eigen::Affine3d take_pose(ArrayReader& in) {
  const auto numbers = in.number<Matrix>();
  Eigen::Affine3d pose;
  std::copy(numbers.begin(), numbers.end(), pose.matrix().data());
  if (!pose.matrix().allFinite()) in.refuse();
  return pose;
}

bool is_finite(const std::array<float, 3>& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

// What no triangle uses may be anything and becomes harmless; the rest must have a place.
bool check_vertices(std::vector<Vertex>& vertices, const std::vector<std::uint32_t>& indices) {
  for (const std::uint32_t index : indices)
    if (index >= vertices.size() || !is_finite(vertices[index].position)) return false;
  for (Vertex& vertex : vertices) {
    if (!is_finite(vertex.position)) vertex.position = {0, 0, 0};
    if (!is_finite(vertex.normal)) vertex.normal = {0, 0, 1};
    if (!std::isfinite(vertex.uv[0]) || !std::isfinite(vertex.uv[1])) vertex.uv = {0, 0};
  }
  return true;
}

bool take_skin(ArrayReader& in, const Mesh& mesh, Skin& skin) {
  skin.nodes.resize(static_cast<std::size_t>(in.count(max_nodes)));
  for (std::size_t i = 0; i < skin.nodes.size() && in.ok(); ++i) {
    SkinNode& node = skin.nodes[i];
    node.name = in.text(max_name);
    node.parent = static_cast<int>(in.number<std::int64_t>());
    node.in_parent = take_pose(in);
    if (node.parent < -1 || node.parent >= static_cast<int>(i)) return false;
  }
  skin.bones.resize(static_cast<std::size_t>(in.count(65536)));
  for (SkinBone& bone : skin.bones) {
    bone.node = in.number<std::uint32_t>();
    bone.from_mesh = take_pose(in);
    if (bone.node >= skin.nodes.size()) return false;
  }
  skin.vertices = in.array<Vertex>(max_vertices);
  skin.weights = in.array<SkinWeights>(max_vertices);
  skin.scale = in.number<double>();
  if (!in.ok() || !std::isfinite(skin.scale) || skin.scale == 0 || skin.nodes.empty()) return false;
  if (skin.vertices.size() != mesh.vertices.size() || skin.weights.size() != mesh.vertices.size()) return false;
  for (const SkinWeights& weights : skin.weights) {
    for (std::size_t i = 0; i < weights.bones.size(); ++i) {
      if (weights.bones[i] >= skin.bones.size() || !(weights.shares[i] >= 0 && weights.shares[i] < 1.01F)) return false;
    }
  }
  return check_vertices(skin.vertices, mesh.indices);
}

}  // namespace

void put(ArrayWriter& out, const MeshFile& file, const Skin* skin) {
  static_assert(sizeof(Vertex) == 32 && sizeof(SkinWeights) == 24);
  const Mesh& mesh = file.mesh;
  out.array(mesh.vertices);
  out.array(mesh.indices);
  out.number<std::uint64_t>(mesh.parts.size());
  for (const MeshPart& part : mesh.parts) {
    out.number(part.first_index);
    out.number(part.index_count);
    put(out, part.material);
  }
  out.number<std::uint64_t>(file.images.size());
  for (const EmbeddedImage& image : file.images) {
    out.text(image.name);
    out.array(image.bytes);
  }
  if (skin == nullptr) return;
  out.number<std::uint64_t>(skin->nodes.size());
  for (const SkinNode& node : skin->nodes) {
    out.text(node.name);
    out.number<std::int64_t>(node.parent);
    put(out, node.in_parent);
  }
  out.number<std::uint64_t>(skin->bones.size());
  for (const SkinBone& bone : skin->bones) {
    out.number(bone.node);
    put(out, bone.from_mesh);
  }
  out.array(skin->vertices);
  out.array(skin->weights);
  out.number(skin->scale);
}

bool take(ArrayReader& in, MeshFile& file, Skin* skin) {
  Mesh& mesh = file.mesh;
  mesh.vertices = in.array<Vertex>(max_vertices);
  mesh.indices = in.array<std::uint32_t>(max_indices);
  mesh.parts.resize(static_cast<std::size_t>(in.count(max_parts)));
  std::uint64_t next = 0;
  for (MeshPart& part : mesh.parts) {
    part.first_index = in.number<std::uint32_t>();
    part.index_count = in.number<std::uint32_t>();
    part.material = take_material(in);
    if (part.first_index != next || part.index_count % 3 != 0) return false;
    next += part.index_count;
  }
  if (!in.ok() || next != mesh.indices.size() || mesh.indices.empty()) return false;
  file.images.resize(static_cast<std::size_t>(in.count(max_images)));
  for (EmbeddedImage& image : file.images) {
    image.name = in.text(max_name);
    image.bytes = in.array<std::uint8_t>(max_image_file);
  }
  if (!in.ok() || !check_vertices(mesh.vertices, mesh.indices)) return false;
  return skin == nullptr || take_skin(in, mesh, *skin);
}

void put(ArrayWriter& out, const std::vector<RawTrack>& tracks) {
  out.number<std::uint64_t>(tracks.size());
  for (const RawTrack& track : tracks) {
    out.text(track.node);
    out.array(track.position_times);
    out.array(track.rotation_times);
    out.array(track.positions);
    out.array(track.rotations);
  }
}

bool take_tracks(ArrayReader& in, std::vector<RawTrack>& tracks) {
  tracks.resize(static_cast<std::size_t>(in.count(max_nodes)));
  for (RawTrack& track : tracks) {
    track.node = in.text(max_name);
    track.position_times = in.array<double>(max_keys);
    track.rotation_times = in.array<double>(max_keys);
    track.positions = in.array<std::array<float, 3>>(max_keys);
    track.rotations = in.array<std::array<float, 4>>(max_keys);
    if (track.position_times.size() != track.positions.size() || track.rotation_times.size() != track.rotations.size()) return false;
  }
  return in.ok();
}

void put(ArrayWriter& out, const Image& image) {
  out.number<std::int64_t>(image.width);
  out.number<std::int64_t>(image.height);
  out.array(image.rgba);
}

bool take_image(ArrayReader& in, Image& image) {
  const auto width = in.number<std::int64_t>(), height = in.number<std::int64_t>();
  if (width < 1 || height < 1 || width > largest_image || height > largest_image) return false;
  image = {static_cast<int>(width), static_cast<int>(height), {}};
  image.rgba = in.array<std::uint8_t>(image.size_bytes());
  return in.ok() && image.rgba.size() == image.size_bytes();
}

}  // namespace sim
