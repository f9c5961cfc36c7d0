// The frustum of a view as matrices and planes. Values; any thread.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "render/renderer.h"

namespace sim {

// From world axes relative to the camera to clip coordinates; y is turned down so that rows come out from the top.
Eigen::Matrix4d view_projection(const View& view);

// The six planes of a frustum, pointing inwards, of unit normals; for points relative to the camera. The fifth is the near one.
std::array<Eigen::Vector4d, 6> frustum_planes(const Eigen::Matrix4d& view_projection);

// Whether all of the box is beyond one of the planes; `place` takes it to where they are.
bool is_box_outside(const Eigen::AlignedBox3d& box, const Eigen::Matrix4d& place, const std::array<Eigen::Vector4d, 6>& planes);

}  // namespace sim
