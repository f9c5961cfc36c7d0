#include "render/frustum.h"

#include <algorithm>
#include <cmath>

namespace sim {

Eigen::Matrix4d view_projection(const View& view) {
  Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
  turn.block<1, 3>(0, 0) = -view.pose.linear().col(1).transpose();
  turn.block<1, 3>(1, 0) = view.pose.linear().col(2).transpose();
  turn.block<1, 3>(2, 0) = view.pose.linear().col(0).transpose();  // depth, positive ahead
  Eigen::Matrix4d project = Eigen::Matrix4d::Zero();
  const double width = view.right - view.left, height = view.top - view.bottom, n = view.near_clip, f = view.far_clip;
  project(0, 0) = 2 / width;
  project(1, 1) = -2 / height;
  const double dx = (view.right + view.left) / width, dy = (view.top + view.bottom) / height;
  if (view.is_parallel) {
    project(0, 3) = -dx;
    project(1, 3) = dy;
    project(2, 2) = 2 / (f - n);
    project(2, 3) = -(f + n) / (f - n);
    project(3, 3) = 1;
  } else {
    project(0, 2) = -dx;
    project(1, 2) = dy;
    project(2, 2) = (f + n) / (f - n);
    project(2, 3) = -2 * f * n / (f - n);
    project(3, 2) = 1;
  }
  return project * turn;
}

std::array<Eigen::Vector4d, 6> frustum_planes(const Eigen::Matrix4d& m) {
  std::array<Eigen::Vector4d, 6> planes;
  for (int i = 0; i < 3; ++i) {
    planes[static_cast<std::size_t>(2 * i)] = m.row(3) + m.row(i);
    planes[static_cast<std::size_t>(2 * i + 1)] = m.row(3) - m.row(i);
  }
  for (auto& plane : planes) plane /= plane.head<3>().norm();
  return planes;
}

bool is_box_outside(const Eigen::AlignedBox3d& box, const Eigen::Matrix4d& place, const std::array<Eigen::Vector4d, 6>& planes) {
  const Eigen::Vector3d centre = (place * box.center().homogeneous()).head<3>();
  const Eigen::Matrix3d sides = place.topLeftCorner<3, 3>() * (0.5 * box.sizes()).asDiagonal();
  return std::any_of(planes.begin(), planes.end(), [&](const Eigen::Vector4d& plane) {
    const Eigen::Vector3d normal = plane.head<3>();
    const double reach = (normal.transpose() * sides).cwiseAbs().sum();
    return normal.dot(centre) + plane.w() < -reach - 1e-6 * (1 + reach);
  });
}

View View::pinhole(const Eigen::Isometry3d& pose, double horizontal_fov, int width, int height) {
  View view;
  view.pose = pose;
  view.width = width;
  view.height = height;
  view.right = std::tan(0.5 * horizontal_fov);
  view.left = -view.right;
  view.top = view.right * height / width;
  view.bottom = -view.top;
  return view;
}

}  // namespace sim
