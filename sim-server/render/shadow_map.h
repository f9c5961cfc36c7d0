// The shadow of the sun: a depth map seen along its rays. What never moves is drawn once and kept; what moves is drawn over a copy if its
// shadow may be seen, and only the patches it touched are put back. Ground planes are never in it. For the thread of the context.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "render/gpu_store.h"

namespace sim {

// Where a picture can show shadows: in a frustum, neither above nor below all that it shows.
struct ShadowView {
  Eigen::Vector3d eye{0, 0, 0};
  Eigen::Vector3d focus{0, 0, 0};         // the place that matters most
  std::array<Eigen::Vector4d, 6> planes;  // frustum_planes(), relative to the eye
  double floor = 0, ceiling = 0;          // [m] z of the lowest and the highest point
};

class ShadowMap {
 public:
  ShadowMap(const gl::Functions& gl, GpuStore& store);

  // Brings the map up to date for these poses; `to_light` is a unit vector. Changes the framebuffer, viewport and program in use. Cheap
  // when nothing has moved.
  base::Result<void> update(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const Eigen::Vector3d& to_light,
                            const ShadowView& view, int size);
  // Everything is drawn anew at the next update.
  void forget() { is_valid_ = false; }

  GLuint texture() const { return working_.name(); }
  // From the world to [0, 1] in the map.
  const Eigen::Matrix4d& matrix() const { return to_map_; }
  double texel() const { return texel_; }  // [m]
  int size() const { return size_; }
  std::uint64_t rebuilds() const { return rebuilds_; }
  std::uint64_t moving_drawn() const { return moving_drawn_; }

 private:
  // A rectangle of the map in pixels; empty when right <= left.
  struct Patch {
    int left = 0, bottom = 0, right = 0, top = 0;
  };
  void allocate(int size);
  Eigen::AlignedBox3d region_of(const Scene& scene, std::span<const Eigen::Isometry3d> poses) const;
  void fit(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const Eigen::Vector3d& to_light, const Eigen::Vector3d& focus);
  bool still_fits(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const Eigen::Vector3d& to_light,
                  const Eigen::Vector3d& focus, int size) const;
  bool may_be_seen(const Drawable& drawable, const Eigen::Isometry3d& pose, const ShadowView& view) const;
  base::Result<void> rebuild(const Scene& scene, std::span<const Eigen::Isometry3d> poses);
  base::Result<void> draw(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const std::vector<bool>& which);
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
  std::vector<bool> drawn_;               // which moving drawables are in working_
  std::uint64_t rebuilds_ = 0, moving_drawn_ = 0;
};

}  // namespace sim
