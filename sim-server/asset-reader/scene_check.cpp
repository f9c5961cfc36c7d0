#include "asset-reader/scene_check.h"

#include <assimp/anim.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/texture.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <string>

#include "base/text.h"
#include "world/triangle_arrays.h"

namespace sim {
namespace {

using Fault = std::string;  // empty: none

template <class T>
bool has_items(T* const* items, unsigned count) {
  return count == 0 || (items != nullptr && std::all_of(items, items + count, [](const T* item) { return item != nullptr; }));
}

// A polygon whose holes are joined to its outline has fewer corners than twice its vertices.
bool has_invented_corners(const aiMesh& mesh, const aiFace& face) {
  return face.mNumIndices > max_unchecked_corners && face.mNumIndices / 2 > mesh.mNumVertices;
}

Fault fault_of_faces(const aiMesh& mesh) {
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (has_invented_corners(mesh, face))
      return fmt::format("face {} has {} corners, its mesh {} vertices", f, face.mNumIndices, mesh.mNumVertices);
    if (face.mNumIndices > 0 && face.mIndices == nullptr) return fmt::format("face {} has no corners", f);
    for (unsigned i = 0; i < face.mNumIndices; ++i)
      if (face.mIndices[i] >= mesh.mNumVertices)
        return fmt::format("face {} names vertex {} of {}", f, face.mIndices[i], mesh.mNumVertices);
  }
  return {};
}

Fault fault_of_bones(const aiMesh& mesh) {
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    if (bone.mNumWeights > 0 && bone.mWeights == nullptr) return fmt::format("bone {} has no weights", b);
    for (unsigned w = 0; w < bone.mNumWeights; ++w)
      if (bone.mWeights[w].mVertexId >= mesh.mNumVertices)
        return fmt::format("bone {} names vertex {} of {}", b, bone.mWeights[w].mVertexId, mesh.mNumVertices);
  }
  return {};
}

Fault fault_of(const aiMesh& mesh) {
  if (mesh.mNumVertices > 0 && mesh.mVertices == nullptr) return "its vertices are missing";
  if (mesh.mNumFaces > 0 && mesh.mFaces == nullptr) return "its faces are missing";
  if (!has_items(mesh.mBones, mesh.mNumBones)) return "a bone is missing";
  Fault fault = fault_of_faces(mesh);
  return fault.empty() ? fault_of_bones(mesh) : fault;
}

Fault fault_of(const aiScene& scene, const aiNode& node, unsigned depth) {
  if (depth > deepest_node) return fmt::format("nodes nest deeper than {}", deepest_node);
  if (node.mNumMeshes > 0 && node.mMeshes == nullptr) return "the meshes of a node are missing";
  for (unsigned i = 0; i < node.mNumMeshes; ++i)
    if (node.mMeshes[i] >= scene.mNumMeshes) return fmt::format("a node names mesh {} of {}", node.mMeshes[i], scene.mNumMeshes);
  if (!has_items(node.mChildren, node.mNumChildren)) return "a node is missing";
  for (unsigned i = 0; i < node.mNumChildren; ++i)
    if (Fault fault = fault_of(scene, *node.mChildren[i], depth + 1); !fault.empty()) return fault;
  return {};
}

Fault fault_of(const aiAnimation& animation) {
  if (!has_items(animation.mChannels, animation.mNumChannels)) return "a channel of an animation is missing";
  for (unsigned c = 0; c < animation.mNumChannels; ++c) {
    const aiNodeAnim& channel = *animation.mChannels[c];
    if ((channel.mNumPositionKeys > 0 && channel.mPositionKeys == nullptr) ||
        (channel.mNumRotationKeys > 0 && channel.mRotationKeys == nullptr))
      return fmt::format("the keys of channel {} are missing", c);
  }
  return {};
}

Fault fault_of(const aiScene& scene) {
  if (!has_items(scene.mMeshes, scene.mNumMeshes)) return "a mesh is missing";
  if (!has_items(scene.mMaterials, scene.mNumMaterials)) return "a material is missing";
  if (!has_items(scene.mTextures, scene.mNumTextures)) return "a picture is missing";
  if (!has_items(scene.mAnimations, scene.mNumAnimations)) return "an animation is missing";
  for (unsigned i = 0; i < scene.mNumMeshes; ++i)
    if (const Fault fault = fault_of(*scene.mMeshes[i]); !fault.empty())
      return fmt::format("mesh {} {}: {}", i, base::in_quotes(scene.mMeshes[i]->mName.C_Str()), fault);
  for (unsigned i = 0; i < scene.mNumTextures; ++i)
    if (scene.mTextures[i]->mWidth > 0 && scene.mTextures[i]->pcData == nullptr) return fmt::format("picture {} is empty", i);
  for (unsigned i = 0; i < scene.mNumAnimations; ++i)
    if (Fault fault = fault_of(*scene.mAnimations[i]); !fault.empty()) return fault;
  return fault_of(scene, *scene.mRootNode, 0);
}

}  // namespace

base::Result<void> check_scene(const aiScene& scene) {
  if (const Fault fault = fault_of(scene); !fault.empty()) return base::Error{"is damaged: " + fault};
  return {};
}

base::Error lost_corner(const Eigen::Vector3d& at) {
  return {fmt::format("is damaged: a triangle has a corner at {} {} {}, expected numbers up to {} m", at.x(), at.y(), at.z(),
                      largest_coordinate)};
}

void drop_empty_faces(const aiScene& scene) {
  for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
    aiMesh& mesh = *scene.mMeshes[i];
    const auto is_empty = [](const aiFace& face) { return face.mNumIndices == 0; };
    aiFace* end = mesh.mFaces + mesh.mNumFaces;
    aiFace* kept_end = std::remove_if(mesh.mFaces, end, is_empty);
    if (kept_end == end) continue;
    mesh.mNumFaces = static_cast<unsigned>(kept_end - mesh.mFaces);
    if (std::none_of(mesh.mFaces, kept_end, [](const aiFace& face) { return face.mNumIndices > 3; }))
      mesh.mPrimitiveTypes &= ~static_cast<unsigned>(aiPrimitiveType_POLYGON);
  }
}

}  // namespace sim
