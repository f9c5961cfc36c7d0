// Limbs that move: a mesh that hangs on a skeleton, and animations of the skeleton. Values; any thread.
//
// Bones of an actor are links of the scene after the actor's own, so that their poses come with every snapshot; vertices are bent once for
// each context and picture.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "render/mesh.h"

namespace sim {

// A place of the skeleton. Parents come before their children.
struct SkinNode {
  std::string name;
  int parent = -1;
  Eigen::Affine3d in_parent = Eigen::Affine3d::Identity();  // at rest
};

// A node that vertices hang on.
struct SkinBone {
  std::uint32_t node = 0;
  Eigen::Affine3d from_mesh = Eigen::Affine3d::Identity();  // from the vertices of the file; with the scale of the node, which poses lack
};

struct SkinWeights {
  std::array<std::uint16_t, 4> bones{};
  std::array<float, 4> shares{1, 0, 0, 0};  // their sum is 1
};

struct Skin {
  std::vector<SkinNode> nodes;
  std::vector<SkinBone> bones;
  std::vector<Vertex> vertices;      // as the file has them
  std::vector<SkinWeights> weights;  // one for each vertex
  double scale = 1;                  // metres in a unit of the file
};

// Positions and rotations of nodes over time; a node without a track keeps still. Changes of scale are left out.
struct SkinAnimation {
  struct Track {
    std::uint32_t node = 0;
    std::vector<double> position_times, rotation_times;  // [s]; ascending, may be empty
    std::vector<Eigen::Vector3d> positions;
    std::vector<Eigen::Quaterniond> rotations;
  };
  double length = 0;          // [s]
  std::vector<Track> tracks;  // of each node after its parent's
  // The way along x of its first moving node [m]: how far one round of steps leads.
  double stride = 0;
  std::size_t stride_track = 0;
};

// When in the animation [s] a walker has come so far [m]; the animation is repeated. For a stride that is not 0.
double time_at_distance(const SkinAnimation& animation, double distance);

// Of the bones, in the frame of the skin [m]; without animation at rest. `stays`: the way along x is left out, since the body follows a
// way of its own.
std::vector<Eigen::Isometry3d> bone_poses(const Skin& skin, const SkinAnimation* animation, double seconds, bool stays);

// The vertices with the bones at these poses, in the frame in which the poses are.
void bend(const Skin& skin, std::span<const Eigen::Isometry3d> bones, std::vector<Vertex>& out);

struct SkinFile {
  Mesh mesh;  // at rest [m]
  std::vector<EmbeddedImage> images;
  Skin skin;
  FileStamps files;  // that it was read from
};

// COLLADA, glTF and the like, also of things without a skeleton. `scale`: metres in a unit of the file.
base::Result<SkinFile> read_skin_file(const std::string& path, double scale, const ModelPath& model_path = {});

// Of COLLADA, BVH and the like. Nodes are known by their names; fails when none of them is the skin's. `scale`: metres in a unit
// of the file.
base::Result<SkinAnimation> read_skin_animation(const std::string& path, double scale, const Skin& skin);

}  // namespace sim
