// The shadow of the sun: a depth map seen along its rays. What never moves is drawn once and kept; what moves is drawn over a copy, and
// only the patches it touched are put back. Ground planes are never in it. For the thread of the context.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "render/gpu_store.h"

namespace sim {

class ShadowMap {
 public:
  ShadowMap(const gl::Functions& gl, GpuStore& store);

  // Brings the map up to date for these poses; `to_light` is a unit vector, `focus` the place in the world that matters most. Changes the
  // framebuffer, viewport and program in use. Cheap when nothing has moved.
  base::Result<void> update(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const Eigen::Vector3d& to_light,
                            const Eigen::Vector3d& focus, int size);
  // Everything is drawn anew at the next update.
  void forget() { is_valid_ = false; }

  GLuint texture() const { return working_.name(); }
  // From the world to [0, 1] in the map.
  const Eigen::Matrix4d& matrix() const { return to_map_; }
  double texel() const { return texel_; }  // [m]
  int size() const { return size_; }
  std::uint64_t rebuilds() const { return rebuilds_; }

 private:
  // A rectangle of the map in pixels; empty when right <= left.
  struct Patch {
    int left = 0, bottom = 0, right = 0, top = 0;
  };
  void allocate(int size);
  void fit(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const Eigen::Vector3d& to_light, const Eigen::Vector3d& focus);
  bool still_fits(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const Eigen::Vector3d& to_light,
                  const Eigen::Vector3d& focus, int size) const;
  base::Result<void> draw(const Scene& scene, std::span<const Eigen::Isometry3d> poses, bool is_static);
  void restore_patches();
  Patch patch_of(const Drawable& drawable, const Eigen::Isometry3d& pose) const;
  Eigen::Vector3d snapped(const Eigen::Vector3d& focus) const;

  const gl::Functions& gl_;
  GpuStore& store_;
  gl::Object kept_, working_, framebuffer_;
  int size_ = 0;
  bool is_valid_ = false;
  bool covers_all_ = true;  // else only a square round the focus
  Eigen::Vector3d to_light_{0, 0, 1};
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  // rows: right, up, to the light
  Eigen::AlignedBox3d region_;                          // in those axes
  Eigen::Vector3d focus_{0, 0, 0};                      // snapped, in those axes
  Eigen::Matrix4d to_clip_ = Eigen::Matrix4d::Identity(), to_map_ = Eigen::Matrix4d::Identity();
  double texel_ = 0;
  std::vector<Eigen::Isometry3d> poses_;  // of the last update
  std::vector<Patch> dirty_;              // of working_: where it differs from kept_
  std::uint64_t rebuilds_ = 0;
};

}  // namespace sim
