#include "render/frustum.h"

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
