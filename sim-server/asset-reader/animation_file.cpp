// Animations of skeletons from files, by Assimp.
#include <assimp/scene.h>

#include <algorithm>

#include "asset-reader/import.h"
#include "asset-reader/jobs.h"
#include "render/mesh_arrays.h"

namespace sim {

base::Result<void> read_animation(Job& job) {
  Import import(job.path, job.files);
  const auto read = import.read(0);
  if (!read) return read.error();
  const aiScene& scene = **read;
  if (scene.mNumAnimations == 0) return base::Error{"has no animation"};
  const aiAnimation& animation = **std::max_element(scene.mAnimations, scene.mAnimations + scene.mNumAnimations,
                                                    [](const auto* a, const auto* b) { return a->mNumChannels < b->mNumChannels; });
  const double ticks = animation.mTicksPerSecond > 0 ? animation.mTicksPerSecond : 1;
  std::vector<RawTrack> tracks;
  for (unsigned c = 0; c < animation.mNumChannels; ++c) {
    const aiNodeAnim& in = *animation.mChannels[c];
    RawTrack& track = tracks.emplace_back();
    track.node = in.mNodeName.C_Str();
    for (unsigned i = 0; i < in.mNumPositionKeys; ++i) {
      const auto& [time, v] = in.mPositionKeys[i];
      track.position_times.push_back(time / ticks);
      track.positions.push_back({v.x, v.y, v.z});
    }
    for (unsigned i = 0; i < in.mNumRotationKeys; ++i) {
      const aiQuatKey& key = in.mRotationKeys[i];
      track.rotation_times.push_back(key.mTime / ticks);
      track.rotations.push_back({key.mValue.w, key.mValue.x, key.mValue.y, key.mValue.z});
    }
  }
  put(job.out, tracks);
  return {};
}

}  // namespace sim
