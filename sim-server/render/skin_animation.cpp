// Animations of skeletons from files: asks the reader of files, and finds the nodes of a skin.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "reader/asset_reader.h"
#include "render/mesh_arrays.h"
#include "render/skin.h"

namespace sim {
namespace {

// A key that is no number, or earlier than the one before it, is left out.
template <class Raw, class Value, class Convert>
void take_keys(const std::vector<double>& raw_times, const std::vector<Raw>& raw, std::vector<double>& times, std::vector<Value>& values,
               const Convert& convert) {
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const double time = raw_times[i];
    const Value value = convert(raw[i]);
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

SkinAnimation::Track to_track(const RawTrack& in, std::uint32_t node, double scale) {
  SkinAnimation::Track out;
  out.node = node;
  take_keys(in.position_times, in.positions, out.position_times, out.positions,
            [&](const std::array<float, 3>& v) { return Eigen::Vector3d(scale * Eigen::Vector3d(v[0], v[1], v[2])); });
  take_keys(in.rotation_times, in.rotations, out.rotation_times, out.rotations,
            [](const std::array<float, 4>& q) { return Eigen::Quaterniond(q[0], q[1], q[2], q[3]); });
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
  const AssetReader::Question question{AssetKind::animation, path, "animation", {}};
  const auto raw = AssetReader::decoded<std::vector<RawTrack>>(question, AssetReader::mine().ask(question), take_tracks);
  if (!raw) return raw.error();
  std::map<std::string, std::uint32_t> nodes;
  for (std::uint32_t i = 0; i < skin.nodes.size(); ++i) nodes.try_emplace(skin.nodes[i].name, i);
  SkinAnimation out;
  for (const RawTrack& track_of_file : *raw) {
    const auto found = nodes.find(track_of_file.node);
    if (found == nodes.end()) continue;
    out.tracks.push_back(to_track(track_of_file, found->second, scale / skin.scale));
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
}

}  // namespace sim
