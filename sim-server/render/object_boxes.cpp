#include "render/object_boxes.h"

#include <algorithm>
#include <array>

namespace sim {
namespace {

// Calls `take` with the corners of each triangle of the object, brought there by `place`(link).
template <class Place, class Take>
void each_triangle(const Scene& scene, const SceneObject& object, Place place, Take take) {
  for (const std::uint32_t index : object.drawables) {
    const Drawable& drawable = scene.drawables[index];
    const Eigen::Affine3d to = Eigen::Affine3d(place(drawable.link).matrix()) * drawable.in_link;
    const Mesh& mesh = *drawable.mesh;
    const MeshPart& part = mesh.parts[drawable.part];
    for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) {
      std::array<Eigen::Vector3d, 3> corners;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const auto& position = mesh.vertices[mesh.indices[part.first_index + i + k]].position;
        corners[k] = to * Eigen::Vector3d(position[0], position[1], position[2]);
      }
      take(corners);
    }
  }
}

}  // namespace

std::optional<ImageBox> image_box(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const SceneObject& object,
                                  const View& view) {
  const Eigen::Isometry3d to_camera = view.pose.inverse();
  Eigen::AlignedBox2d box;
  const auto see = [&](const Eigen::Vector3d& p) {
    const double right = -p.y() / p.x(), up = p.z() / p.x();
    box.extend(Eigen::Vector2d((right - view.left) / (view.right - view.left) * view.width,
                               (view.top - up) / (view.top - view.bottom) * view.height));
  };
  const double near = view.near_clip;
  const auto see_triangle = [&](const std::array<Eigen::Vector3d, 3>& corners) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d &a = corners[i], &b = corners[(i + 1) % 3];
      if (a.x() >= near) see(a);
      if ((a.x() >= near) != (b.x() >= near)) see(a + (near - a.x()) / (b.x() - a.x()) * (b - a));
    }
  };
  each_triangle(
      scene, object, [&](std::uint32_t link) { return to_camera * poses[link]; }, see_triangle);
  const Eigen::AlignedBox2d image(Eigen::Vector2d(0, 0), Eigen::Vector2d(view.width, view.height));
  box = box.intersection(image);
  if (box.isEmpty()) return std::nullopt;
  return ImageBox{box.min().x(), box.min().y(), box.max().x(), box.max().y()};
}

OrientedBox oriented_box(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const SceneObject& object) {
  const Eigen::Isometry3d frame = poses[object.link] * object.frame, back = frame.inverse();
  Eigen::AlignedBox3d box;
  each_triangle(
      scene, object, [&](std::uint32_t link) { return back * poses[link]; },
      [&](const std::array<Eigen::Vector3d, 3>& corners) {
        for (const auto& corner : corners) box.extend(corner);
      });
  OrientedBox out;
  out.pose = frame;
  if (box.isEmpty()) return out;
  out.pose.translate(box.center());
  out.size = box.sizes();
  return out;
}

}  // namespace sim
