// Triangles for physics and rays, by Assimp.
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "asset-reader/import.h"
#include "asset-reader/jobs.h"
#include "asset-reader/scene_check.h"
#include "base/text.h"
#include "world/triangle_arrays.h"

namespace sim {
namespace {

bool is_finite(const Eigen::Vector3d& v) { return v.allFinite() && v.cwiseAbs().maxCoeff() < largest_coordinate; }

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
      if (face.mNumIndices != 3 || out.triangles.size() >= max_triangles) continue;
      out.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    collect(scene, *node.mChildren[i], transform, shape, wanted && !shape.submesh.empty(), out);
}

// An error for a triangle with a corner that has no place.
base::Result<void> finish_mesh(const MeshShape& shape, TriangleMesh& mesh) {
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t corner : t)
      if (!is_finite(mesh.vertices[corner])) return lost_corner(mesh.vertices[corner]);
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
  return {};
}

base::Result<TriangleMesh> read_mesh(const MeshShape& shape, FileLog& files, bool by_id = false) {
  Import import(shape.path, files);
  // Gazebo finds submeshes by the names of their nodes, older worlds of ours by their ids.
  import.importer().SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, !shape.submesh.empty() && !by_id);
  import.importer().SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  import.importer().SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS |
                                                                   aiComponent_COLORS | aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS |
                                                                   aiComponent_ANIMATIONS | aiComponent_TEXTURES | aiComponent_LIGHTS |
                                                                   aiComponent_CAMERAS | aiComponent_MATERIALS);
  const auto scene = import.read(aiProcess_Triangulate | aiProcess_RemoveComponent | aiProcess_JoinIdenticalVertices |
                                 aiProcess_SortByPType | aiProcess_FindDegenerates);
  if (!scene) return scene.error();
  TriangleMesh mesh;
  collect(**scene, *(*scene)->mRootNode, aiMatrix4x4(), shape, false, mesh);
  if (mesh.triangles.empty() && !shape.submesh.empty() && !by_id) return read_mesh(shape, files, true);
  if (const auto finished = finish_mesh(shape, mesh); !finished) return finished.error();
  if (mesh.triangles.empty())
    return base::Error{shape.submesh.empty() ? "has no triangle" : fmt::format("has no submesh {}", base::in_quotes(shape.submesh))};
  return mesh;
}

}  // namespace

base::Result<void> read_triangles(Job& job) {
  const MeshShape shape = take_shape(job.in, job.path);
  const auto mesh = read_mesh(shape, job.files);
  if (!mesh) return mesh.error();
  for (const auto& vertex : mesh.value().vertices) {
    if (!is_finite(vertex)) return base::Error{fmt::format("is larger than {} m with its scale", largest_coordinate)};
  }
  put(job.out, *mesh);
  return {};
}

}  // namespace sim
