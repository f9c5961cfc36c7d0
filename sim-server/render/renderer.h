// Draws a scene into memory, without a display or GPU: one context of llvmpipe with what it holds of the scene. One thread at a time;
// several renderers may work in as many threads. Pictures depend on nothing but what is given: the same calls make the same bytes. How
// light falls is written down in shaders.h.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/result.h"
#include "render/image.h"
#include "render/overlay.h"
#include "render/scene.h"

namespace sim {

// Where a picture is taken from, and how.
struct View {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // of the camera in the world: it looks along x, y is left, z is up
  int width = 320, height = 240;
  // The picture's edges: tangents of their angles off the axis; for parallel views [m] off the axis.
  double left = -1, right = 1, bottom = -0.75, top = 0.75;
  double near_clip = 0.1, far_clip = 100;  // [m] along the axis
  bool is_parallel = false;
  std::uint32_t visibility_mask = 0xffffffff;
  bool wants_color = true;   // false: only read_depth() may follow; much cheaper
  bool wants_marks = false;  // instead of colours: what is seen where, see render/marks.h
  // With colours, in place of the opacity: 1 + index of the object that is seen, 0: none. Only of scenes that can_show_objects().
  bool wants_objects = false;
  bool wants_exact_depth =
      false;               // spheres, ellipsoids, cylinders and capsules are round; otherwise, and for parallel views, they have facets
  int shadow_size = 1024;  // pixels a side of the shadow map; 0: no shadows
  int shadow_taps = 1;     // a side, for soft edges
  bool grid = false;       // metre lines on ground planes
  double pixel_scale = 1;  // pixels drawn per pixel that line widths and letters of overlays speak of

  // Square pixels, the axis through the picture's middle; horizontal field of view in (0, pi) [rad].
  static View pinhole(const Eigen::Isometry3d& pose, double horizontal_fov, int width, int height);
};

class Renderer {
 public:
  // Fails when OSMesa gives no context.
  static base::Result<std::unique_ptr<Renderer>> open();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // `poses`: one per link of the scene. The picture stays here until the next draw. Fails for sizes that llvmpipe does not make, for poses
  // that are not as many as the links, and for clip planes or edges that make no frustum.
  base::Result<void> draw(const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses, const View& view,
                          const Overlay* overlay = nullptr);

  // Of the last draw; rows from the top down. 4 bytes a pixel: red, green, blue (sRGB), opacity; or its mark.
  void read_rgba(std::span<std::uint8_t> out);
  // [m] along the axis; +infinity where nothing is.
  void read_depth(std::span<float> out);

  struct Statistics {
    std::uint64_t draws = 0;            // pictures
    std::uint64_t drawn = 0;            // drawables in the last picture
    std::uint64_t culled = 0;           // drawables outside the last picture's frustum
    std::uint64_t shadow_rebuilds = 0;  // of the static shadow map
    std::uint64_t moving_shadows = 0;   // of moving drawables, in all pictures
  };
  Statistics statistics() const;

 private:
  class Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Few objects, and nothing that is seen through: then one drawing gives the colours and what is seen where.
bool can_show_objects(const Scene& scene);

// A picture for people: drawn twice as large and averaged in linear light, soft shadows.
base::Result<Image> draw_smooth(Renderer& renderer, const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses,
                                View view, const Overlay* overlay = nullptr);

}  // namespace sim
