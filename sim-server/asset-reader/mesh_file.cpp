// Meshes and skins from files, by Assimp: geometry, materials, pictures inside the file.
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "asset-reader/import.h"
#include "asset-reader/jobs.h"
#include "asset-reader/scene_check.h"
#include "base/text.h"
#include "render/mesh_arrays.h"
#include "world/triangle_arrays.h"

namespace sim {
namespace {

Eigen::Affine3d to_affine(const aiMatrix4x4& in) {
  Eigen::Matrix4d out;
  out << in.a1, in.a2, in.a3, in.a4, in.b1, in.b2, in.b3, in.b4, in.c1, in.c2, in.c3, in.c4, in.d1, in.d2, in.d3, in.d4;
  return Eigen::Affine3d(out);
}

Color to_color(const aiColor4D& c) { return {c.r, c.g, c.b, c.a}; }

class MeshReader {
 public:
  // With a skin the vertices are taken as they hang on the skeleton at rest.
  MeshReader(const aiScene& scene, const MeshShape& shape, Skin* skin) : scene_(scene), shape_(shape), skin_(skin) {}

  // An error for a triangle with a corner that has no place.
  base::Result<MeshFile> read() {
    if (skin_ != nullptr) add_nodes(*scene_.mRootNode, -1);
    collect(*scene_.mRootNode, aiMatrix4x4(), false);
    if (lost_) return *lost_;
    for (auto& [index, indices] : indices_by_material_) {
      repair_normals(indices);
      MeshPart part{
          static_cast<std::uint32_t>(out_.mesh.indices.size()), static_cast<std::uint32_t>(indices.size()), material(index), {}, false};
      out_.mesh.indices.insert(out_.mesh.indices.end(), indices.begin(), indices.end());
      out_.mesh.parts.push_back(std::move(part));
    }
    if (skin_ != nullptr) hang();
    place();
    return std::move(out_);
  }

 private:
  void add_nodes(const aiNode& node, int parent) {
    const auto index = static_cast<std::uint32_t>(skin_->nodes.size());
    skin_->nodes.push_back({node.mName.C_Str(), parent, to_affine(node.mTransformation)});
    node_by_name_.try_emplace(node.mName.C_Str(), index);
    node_by_place_.emplace(&node, index);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add_nodes(*node.mChildren[i], static_cast<int>(index));
  }

  // Parts of a mesh, one for each material, share their bones.
  std::uint16_t add_bone(std::uint32_t node, const Eigen::Affine3d& from_mesh) {
    for (std::size_t i = 0; i < skin_->bones.size(); ++i) {
      const SkinBone& bone = skin_->bones[i];
      if (bone.node == node && bone.from_mesh.matrix() == from_mesh.matrix()) return static_cast<std::uint16_t>(i);
    }
    skin_->bones.push_back({node, from_mesh});
    return static_cast<std::uint16_t>(skin_->bones.size() - 1);
  }

  // What hangs on no bone hangs on its node.
  void add_weights(const aiMesh& mesh, const aiNode& node, std::size_t first) {
    auto& weights = skin_->weights;
    weights.resize(first + mesh.mNumVertices, SkinWeights{{}, {0, 0, 0, 0}});
    for (unsigned b = 0; b < mesh.mNumBones && skin_->bones.size() < max_bones; ++b) {
      const aiBone& in = *mesh.mBones[b];
      const auto found = node_by_name_.find(in.mName.C_Str());
      if (found == node_by_name_.end()) continue;
      const std::uint16_t bone = add_bone(found->second, to_affine(in.mOffsetMatrix));
      for (unsigned w = 0; w < in.mNumWeights; ++w) {
        const auto& [vertex, share] = in.mWeights[w];
        if (vertex >= mesh.mNumVertices || !(share > 0)) continue;
        auto& shares = weights[first + vertex].shares;
        const auto place = std::min_element(shares.begin(), shares.end());
        if (share <= *place) continue;
        *place = share;
        weights[first + vertex].bones[static_cast<std::size_t>(place - shares.begin())] = bone;
      }
    }
    std::optional<std::uint16_t> own;
    for (std::size_t v = first; v < weights.size(); ++v) {
      auto& [bones, shares] = weights[v];
      const float sum = shares[0] + shares[1] + shares[2] + shares[3];
      if (sum > 0) {
        for (auto& share : shares) share /= sum;
        // The greatest first, so that the first one that is 0 ends the list.
        for (std::size_t i = 0; i < 3; ++i) {
          const auto greatest =
              static_cast<std::size_t>(std::max_element(shares.begin() + static_cast<std::ptrdiff_t>(i), shares.end()) - shares.begin());
          std::swap(shares[i], shares[greatest]);
          std::swap(bones[i], bones[greatest]);
        }
        continue;
      }
      if (!own) own = add_bone(node_by_place_.at(&node), Eigen::Affine3d::Identity());
      bones = {*own, 0, 0, 0};
      shares = {1, 0, 0, 0};
    }
  }

  // Bones get the scales that poses lack; the vertices come to where they are at rest.
  void hang() {
    Skin& skin = *skin_;
    skin.scale = shape_.scale.x();
    std::vector<Eigen::Affine3d> poses;
    for (const auto& node : skin.nodes)
      poses.push_back(node.parent < 0 ? node.in_parent : poses[static_cast<std::size_t>(node.parent)] * node.in_parent);
    for (auto& bone : skin.bones) {
      const Eigen::Vector3d scale = skin.scale * poses[bone.node].linear().colwise().norm().transpose();
      bone.from_mesh = Eigen::Affine3d(Eigen::Scaling(scale)) * bone.from_mesh;
    }
    skin.vertices = out_.mesh.vertices;
    bend(skin, bone_poses(skin, nullptr, 0, false), out_.mesh.vertices);
  }

  void collect(const aiNode& node, const aiMatrix4x4& parent, bool is_inside) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    const bool is_wanted = is_inside || shape_.submesh.empty() || shape_.submesh == node.mName.C_Str();
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[i]];
      if (!is_wanted && shape_.submesh != mesh.mName.C_Str()) continue;
      const std::size_t first = out_.mesh.vertices.size();
      add(mesh, transform);
      if (skin_ != nullptr) add_weights(mesh, node, first);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) collect(*node.mChildren[i], transform, is_wanted && !shape_.submesh.empty());
  }

  void add(const aiMesh& mesh, const aiMatrix4x4& to_root) {
    const aiMatrix4x4 transform = skin_ != nullptr ? aiMatrix4x4() : to_root;
    const auto first = static_cast<std::uint32_t>(out_.mesh.vertices.size());
    aiMatrix3x3 normals(transform);
    normals.Inverse().Transpose();
    const bool is_mirrored = aiMatrix3x3(to_root).Determinant() < 0;
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = transform * mesh.mVertices[v];
      const aiVector3D n = mesh.HasNormals() ? (normals * mesh.mNormals[v]).NormalizeSafe() : aiVector3D(0, 0, 1);
      const aiVector3D t = mesh.HasTextureCoords(0) ? mesh.mTextureCoords[0][v] : aiVector3D();
      out_.mesh.vertices.push_back({{p.x, p.y, p.z}, {n.x, n.y, n.z}, {t.x, t.y}});
    }
    auto& indices = indices_by_material_[mesh.mMaterialIndex];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3 || indices.size() >= max_triangles * 3) continue;
      const std::uint32_t corners[3] = {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]};
      note_lost(corners);
      if (!is_triangle(corners)) continue;
      indices.push_back(first + face.mIndices[0]);
      indices.push_back(first + face.mIndices[is_mirrored ? 2 : 1]);
      indices.push_back(first + face.mIndices[is_mirrored ? 1 : 2]);
    }
  }

  void note_lost(const std::uint32_t (&corners)[3]) {
    for (const std::uint32_t corner : corners)
      if (!lost_ && !is_finite(corner))
        lost_ = lost_corner(Eigen::Map<const Eigen::Vector3f>(out_.mesh.vertices[corner].position.data()).cast<double>());
  }

  // False for what has no area.
  bool is_triangle(const std::uint32_t (&corners)[3]) const {
    const auto& a = out_.mesh.vertices[corners[0]].position;
    const auto& b = out_.mesh.vertices[corners[1]].position;
    const auto& c = out_.mesh.vertices[corners[2]].position;
    return a != b && b != c && c != a;
  }

  // Normals that the file, or its triangles without area, left useless are made from the triangles about them.
  void repair_normals(const std::vector<std::uint32_t>& indices) {
    auto& vertices = out_.mesh.vertices;
    const auto is_bad = [&](std::uint32_t i) {
      const Eigen::Map<const Eigen::Vector3f> n(vertices[i].normal.data());
      return !n.allFinite() || std::abs(n.squaredNorm() - 1) > 0.1F;
    };
    std::map<std::uint32_t, Eigen::Vector3f> sums;
    for (const auto i : indices)
      if (is_bad(i)) sums.emplace(i, Eigen::Vector3f::Zero());
    if (sums.empty()) return;
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
      const auto at = [&](std::size_t k) {
        return Eigen::Vector3f(Eigen::Map<const Eigen::Vector3f>(vertices[indices[t + k]].position.data()));
      };
      const Eigen::Vector3f cross = (at(1) - at(0)).cross(at(2) - at(0));
      for (std::size_t k = 0; k < 3; ++k)
        if (const auto found = sums.find(indices[t + k]); found != sums.end()) found->second += cross;
    }
    for (const auto& [i, sum] : sums) {
      const Eigen::Vector3f n = sum.norm() > 0 ? Eigen::Vector3f(sum.normalized()) : Eigen::Vector3f(0, 0, 1);
      vertices[i].normal = {n.x(), n.y(), n.z()};
    }
  }

  bool is_finite(std::uint32_t index) const {
    const auto& p = out_.mesh.vertices[index].position;
    return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]) && std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]) < 1e7F;
  }

  MaterialDef material(unsigned index) {
    MaterialDef out;
    if (index >= scene_.mNumMaterials) return out;
    const aiMaterial& in = *scene_.mMaterials[index];
    aiColor4D color;
    if (in.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS) out.diffuse = to_color(color);
    if (in.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS) out.diffuse = to_color(color);
    if (in.Get(AI_MATKEY_COLOR_AMBIENT, color) == aiReturn_SUCCESS) out.ambient = to_color(color);
    if (in.Get(AI_MATKEY_COLOR_SPECULAR, color) == aiReturn_SUCCESS) out.specular = to_color(color);
    if (in.Get(AI_MATKEY_COLOR_EMISSIVE, color) == aiReturn_SUCCESS) out.emissive = to_color(color);
    float number = 0;
    if (in.Get(AI_MATKEY_SHININESS, number) == aiReturn_SUCCESS) out.shininess = number;
    if (in.Get(AI_MATKEY_OPACITY, number) == aiReturn_SUCCESS && number > 0) out.diffuse.a = number;
    if (in.Get(AI_MATKEY_METALLIC_FACTOR, number) == aiReturn_SUCCESS) out.has_pbr = true, out.metalness = number;
    if (in.Get(AI_MATKEY_ROUGHNESS_FACTOR, number) == aiReturn_SUCCESS) out.roughness = number;
    int two_sided = 0;
    if (in.Get(AI_MATKEY_TWOSIDED, two_sided) == aiReturn_SUCCESS) out.double_sided = two_sided != 0;
    for (const auto kind : {aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR}) {
      aiString path;
      if (out.texture.empty() && in.GetTexture(kind, 0, &path) == aiReturn_SUCCESS) out.texture = texture(path.C_Str());
    }
    out.has_alpha_texture = has_alpha_texture(in);
    // Exporters write black beside a texture although the texture is what they mean.
    if (!out.texture.empty() && out.diffuse.r + out.diffuse.g + out.diffuse.b <= 0) out.diffuse = {1, 1, 1, out.diffuse.a};
    return out;
  }

  // The alpha of a picture means something only where the material says that it is not opaque.
  static bool has_alpha_texture(const aiMaterial& in) {
    aiString mode;
    if (in.Get("$mat.gltf.alphaMode", 0, 0, mode) == aiReturn_SUCCESS) return std::string_view(mode.C_Str()) != "OPAQUE";
    return in.GetTextureCount(aiTextureType_OPACITY) > 0;
  }

  std::string texture(const std::string& written) {
    const aiTexture* inside = scene_.GetEmbeddedTexture(written.c_str());
    if (inside == nullptr || inside->mHeight != 0) return written;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(inside->pcData);
    std::string name = shape_.path + "#" + written;
    out_.images.push_back({name, {bytes, bytes + inside->mWidth}});
    return name;
  }

  void place() {
    Eigen::AlignedBox3f box;
    for (const auto index : out_.mesh.indices) box.extend(Eigen::Map<const Eigen::Vector3f>(out_.mesh.vertices[index].position.data()));
    const Eigen::Vector3f centre =
        shape_.center_submesh && !shape_.submesh.empty() && !box.isEmpty() ? Eigen::Vector3f(box.center()) : Eigen::Vector3f::Zero();
    const Eigen::Vector3f scale = skin_ != nullptr ? Eigen::Vector3f::Ones() : Eigen::Vector3f(shape_.scale.cast<float>());
    for (auto& vertex : out_.mesh.vertices) {
      Eigen::Map<Eigen::Vector3f> position(vertex.position.data());
      Eigen::Map<Eigen::Vector3f> normal(vertex.normal.data());
      position = (position - centre).cwiseProduct(scale);
      normal = normal.cwiseQuotient(scale).normalized();
    }
    if (shape_.scale.prod() < 0) {
      for (std::size_t i = 0; i + 2 < out_.mesh.indices.size(); i += 3) std::swap(out_.mesh.indices[i + 1], out_.mesh.indices[i + 2]);
    }
  }

  const aiScene& scene_;
  const MeshShape& shape_;
  Skin* skin_;  // may be null
  std::map<std::string, std::uint32_t> node_by_name_;
  std::map<const aiNode*, std::uint32_t> node_by_place_;
  MeshFile out_;
  std::map<unsigned, std::vector<std::uint32_t>> indices_by_material_;
  std::optional<base::Error> lost_;
};

base::Result<MeshFile> read_file(const MeshShape& shape, FileLog& files, Skin* skin, bool by_id = false) {
  Import import(shape.path, files);
  // Gazebo finds submeshes by the names of their nodes, older worlds of ours by their ids.
  import.importer().SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, !shape.submesh.empty() && !by_id);
  import.importer().SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  import.importer().SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 45.0F);
  const auto scene = import.read(aiProcess_Triangulate | aiProcess_GenSmoothNormals | aiProcess_JoinIdenticalVertices |
                                 aiProcess_SortByPType | aiProcess_FlipUVs | aiProcess_ImproveCacheLocality | aiProcess_TransformUVCoords);
  if (!scene) return scene.error();
  auto read = MeshReader(**scene, shape, skin).read();
  if (!read) return read.error();
  MeshFile file = std::move(*read);
  if (file.mesh.indices.empty() && !shape.submesh.empty() && !by_id) return read_file(shape, files, skin, true);
  if (file.mesh.indices.empty())
    return base::Error{shape.submesh.empty() ? "has no triangle" : fmt::format("has no submesh {}", base::in_quotes(shape.submesh))};
  return file;
}

}  // namespace

base::Result<void> read_mesh(Job& job) {
  const auto file = read_file(take_shape(job.in, job.path), job.files, nullptr);
  if (!file) return file.error();
  put(job.out, *file, nullptr);
  return {};
}

base::Result<void> read_skin(Job& job) {
  MeshShape shape;
  shape.path = job.path;
  shape.scale.setConstant(job.in.number<double>());
  Skin skin;
  const auto file = read_file(shape, job.files, &skin);
  if (!file) return file.error();
  put(job.out, *file, &skin);
  return {};
}

}  // namespace sim
