// Bending a skin.
#include "render/skin.h"

#include <algorithm>
#include <cmath>

namespace sim {
namespace {

// Where `seconds` lies between two keys: the index of the later one and the share of the way to it.
std::pair<std::size_t, double> between(const std::vector<double>& times, double seconds) {
  const auto later = std::upper_bound(times.begin(), times.end(), seconds);
  if (later == times.begin()) return {0, 1.0};
  if (later == times.end()) return {times.size() - 1, 1.0};
  const auto i = static_cast<std::size_t>(later - times.begin());
  return {i, (seconds - times[i - 1]) / (times[i] - times[i - 1])};
}

Eigen::Vector3d position_at(const SkinAnimation::Track& track, double seconds) {
  const auto [i, share] = between(track.position_times, seconds);
  if (i == 0 || share >= 1) return track.positions[i];
  return (1 - share) * track.positions[i - 1] + share * track.positions[i];
}

Eigen::Quaterniond rotation_at(const SkinAnimation::Track& track, double seconds) {
  const auto [i, share] = between(track.rotation_times, seconds);
  if (i == 0 || share >= 1) return track.rotations[i];
  return track.rotations[i - 1].slerp(share, track.rotations[i]);
}

Eigen::Vector3d column_lengths(const Eigen::Affine3d& pose) { return pose.linear().colwise().norm().transpose(); }

Eigen::Affine3d local_pose(const SkinNode& node, const SkinAnimation& animation, const SkinAnimation::Track& track, double seconds,
                           bool stays) {
  Eigen::Affine3d pose = node.in_parent;
  const Eigen::Vector3d scale = column_lengths(pose);
  if (!track.rotations.empty()) pose.linear() = rotation_at(track, seconds).toRotationMatrix() * scale.asDiagonal();
  if (!track.positions.empty()) {
    Eigen::Vector3d place = position_at(track, seconds);
    if (stays && animation.stride != 0 && &track == &animation.tracks[animation.stride_track]) place.x() = track.positions.front().x();
    pose.translation() = place;
  }
  return pose;
}

}  // namespace

double time_at_distance(const SkinAnimation& animation, double distance) {
  const auto& track = animation.tracks[animation.stride_track];
  const double start = track.positions.front().x(), whole = track.positions.back().x() - start;
  const double rounds = distance / std::abs(animation.stride);
  const double wanted = (rounds - std::floor(rounds)) * std::abs(whole);
  for (std::size_t i = 1; i < track.positions.size(); ++i) {
    const double before = (track.positions[i - 1].x() - start) * (whole < 0 ? -1 : 1);
    const double after = (track.positions[i].x() - start) * (whole < 0 ? -1 : 1);
    if (after < wanted || after <= before) continue;
    const double share = std::clamp((wanted - before) / (after - before), 0.0, 1.0);
    return track.position_times[i - 1] + share * (track.position_times[i] - track.position_times[i - 1]);
  }
  return animation.length;
}

std::vector<Eigen::Isometry3d> bone_poses(const Skin& skin, const SkinAnimation* animation, double seconds, bool stays) {
  std::vector<Eigen::Affine3d> nodes;
  nodes.reserve(skin.nodes.size());
  auto track = animation != nullptr ? animation->tracks.begin() : std::vector<SkinAnimation::Track>::const_iterator();
  for (std::size_t i = 0; i < skin.nodes.size(); ++i) {
    const SkinNode& node = skin.nodes[i];
    Eigen::Affine3d pose = node.in_parent;
    if (animation != nullptr && track != animation->tracks.end() && track->node == i)
      pose = local_pose(node, *animation, *track++, seconds, stays);
    nodes.push_back(node.parent < 0 ? pose : nodes[static_cast<std::size_t>(node.parent)] * pose);
  }
  std::vector<Eigen::Isometry3d> out;
  out.reserve(skin.bones.size());
  for (const auto& bone : skin.bones) {
    const Eigen::Affine3d& pose = nodes[bone.node];
    Eigen::Isometry3d rigid = Eigen::Isometry3d::Identity();
    rigid.translation() = skin.scale * pose.translation();
    rigid.linear() = Eigen::Quaterniond(Eigen::Matrix3d(pose.linear() * column_lengths(pose).cwiseMax(1e-12).cwiseInverse().asDiagonal()))
                         .normalized()
                         .toRotationMatrix();
    out.push_back(rigid);
  }
  return out;
}

void bend(const Skin& skin, std::span<const Eigen::Isometry3d> bones, std::vector<Vertex>& out) {
  std::vector<Eigen::Matrix<float, 3, 4>> matrices;
  matrices.reserve(bones.size());
  for (std::size_t i = 0; i < bones.size(); ++i)
    matrices.push_back((bones[i] * skin.bones[i].from_mesh).matrix().topRows<3>().cast<float>());
  out.resize(skin.vertices.size());
  for (std::size_t v = 0; v < out.size(); ++v) {
    const Vertex& in = skin.vertices[v];
    const SkinWeights& weights = skin.weights[v];
    Eigen::Matrix<float, 3, 4> matrix = weights.shares[0] * matrices[weights.bones[0]];
    for (std::size_t k = 1; k < 4 && weights.shares[k] > 0; ++k) matrix += weights.shares[k] * matrices[weights.bones[k]];
    const Eigen::Vector3f position = matrix.leftCols<3>() * Eigen::Map<const Eigen::Vector3f>(in.position.data()) + matrix.col(3);
    // Bones turn and scale evenly: normals need no matrix of their own.
    const Eigen::Vector3f normal = (matrix.leftCols<3>() * Eigen::Map<const Eigen::Vector3f>(in.normal.data())).normalized();
    out[v] = {{position.x(), position.y(), position.z()}, {normal.x(), normal.y(), normal.z()}, in.uv};
  }
}

}  // namespace sim
