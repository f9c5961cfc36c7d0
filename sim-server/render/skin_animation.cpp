// Animations of skeletons from files, by Assimp.
#include <assimp/config.h>
#include <assimp/scene.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>

#include "base/text.h"
#include "render/skin.h"
#include "world/mesh_io.h"

namespace sim {
namespace {

// A key that is no number, or earlier than the one before it, is left out.
template <class Key, class Value, class Convert>
void take_keys(const Key* keys, unsigned count, double ticks, std::vector<double>& times, std::vector<Value>& values,
               const Convert& convert) {
  for (unsigned i = 0; i < count; ++i) {
    const double time = keys[i].mTime / ticks;
    const Value value = convert(keys[i].mValue);
    if (!std::isfinite(time) || (!times.empty() && time <= times.back())) continue;
    if constexpr (std::is_same_v<Value, Eigen::Vector3d>) {
      if (!value.allFinite()) continue;
    } else {
      if (!value.coeffs().allFinite() || value.norm() < 1e-9) continue;
    }
    times.push_back(time);
    values.push_back(value);
  }
}

SkinAnimation::Track to_track(const aiNodeAnim& in, std::uint32_t node, double ticks, double scale) {
  SkinAnimation::Track out;
  out.node = node;
  take_keys(in.mPositionKeys, in.mNumPositionKeys, ticks, out.position_times, out.positions,
            [&](const aiVector3D& v) { return Eigen::Vector3d(scale * Eigen::Vector3d(v.x, v.y, v.z)); });
  take_keys(in.mRotationKeys, in.mNumRotationKeys, ticks, out.rotation_times, out.rotations,
            [](const aiQuaternion& q) { return Eigen::Quaterniond(q.w, q.x, q.y, q.z); });
  for (auto& rotation : out.rotations) rotation.normalize();
  return out;
}

// Metres for a unit of the parent of a node.
double scale_above(const Skin& skin, std::uint32_t node) {
  Eigen::Affine3d pose = Eigen::Affine3d::Identity();
  for (int i = skin.nodes[node].parent; i >= 0; i = skin.nodes[static_cast<std::size_t>(i)].parent)
    pose = skin.nodes[static_cast<std::size_t>(i)].in_parent * pose;
  return skin.scale * pose.linear().col(0).norm();
}

void find_stride(SkinAnimation& animation, const Skin& skin) {
  for (std::size_t i = 0; i < animation.tracks.size(); ++i) {
    const auto& positions = animation.tracks[i].positions;
    if (positions.size() < 2) continue;
    animation.stride = (positions.back().x() - positions.front().x()) * scale_above(skin, animation.tracks[i].node);
    animation.stride_track = i;
    if (std::abs(animation.stride) < 1e-6) animation.stride = 0;
    return;
  }
}

}  // namespace

base::Result<SkinAnimation> read_skin_animation(const std::string& path, double scale, const Skin& skin) {
  const auto bad = [&](const std::string& why) { return base::Error{fmt::format("animation {}: {}", path, why)}; };
  try {
    Assimp::Importer importer;
    importer.SetIOHandler(new MeshIo);  // the importer's from now on
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
    const aiScene* scene = importer.ReadFile(path, 0);
    if (scene == nullptr) return bad(base::in_quotes(importer.GetErrorString()));
    if (scene->mNumAnimations == 0) return bad("has no animation");
    std::map<std::string, std::uint32_t> nodes;
    for (std::uint32_t i = 0; i < skin.nodes.size(); ++i) nodes.try_emplace(skin.nodes[i].name, i);
    SkinAnimation out;
    const aiAnimation& animation = **std::max_element(scene->mAnimations, scene->mAnimations + scene->mNumAnimations,
                                                      [](const auto* a, const auto* b) { return a->mNumChannels < b->mNumChannels; });
    const double ticks = animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : 1;
    for (unsigned c = 0; c < animation.mNumChannels; ++c) {
      const auto found = nodes.find(animation.mChannels[c]->mNodeName.C_Str());
      if (found == nodes.end()) continue;
      out.tracks.push_back(to_track(*animation.mChannels[c], found->second, ticks, scale / skin.scale));
      const auto& track = out.tracks.back();
      if (!track.position_times.empty()) out.length = std::max(out.length, track.position_times.back());
      if (!track.rotation_times.empty()) out.length = std::max(out.length, track.rotation_times.back());
    }
    if (out.tracks.empty()) return bad("moves no part of the skin");
    if (!(out.length > 0)) return bad("takes no time");
    std::stable_sort(out.tracks.begin(), out.tracks.end(), [](const auto& a, const auto& b) { return a.node < b.node; });
    const auto same = std::unique(out.tracks.begin(), out.tracks.end(), [](const auto& a, const auto& b) { return a.node == b.node; });
    out.tracks.erase(same, out.tracks.end());
    find_stride(out, skin);
    return out;
  } catch (const std::exception& e) {
    return bad(base::in_quotes(e.what()));
  }
}

}  // namespace sim
