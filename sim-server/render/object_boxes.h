// Boxes around whole objects of a scene, seen or not: in the image of a pinhole camera, and in space. Values; any thread.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>

#include "render/renderer.h"

namespace sim {

// [pixel] from the left and the top, within the image.
struct ImageBox {
  double left = 0, top = 0, right = 0, bottom = 0;
};
// Of all that is in front of the camera's near plane; empty when nothing of it falls into the image.
std::optional<ImageBox> image_box(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const SceneObject& object,
                                  const View& view);

// Along the axes of the object's frame.
struct OrientedBox {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // of its middle, in the world
  Eigen::Vector3d size{0, 0, 0};
};
OrientedBox oriented_box(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const SceneObject& object);

}  // namespace sim
