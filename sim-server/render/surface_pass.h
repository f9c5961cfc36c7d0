// Draws the surfaces of a picture, one drawable after the other, each with the program that has just the features it needs. For the thread
// of the context; framebuffer, depth test and blending are the caller's.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "render/gpu_store.h"
#include "render/lights.h"
#include "render/shadow_map.h"

namespace sim {

// What all surfaces of a picture share; the parts outlive the picture.
struct Picture {
  const Scene& scene;
  const View& view;
  const Lights& lights;
  const Eigen::Matrix4d& projection;  // view_projection()
};

// One drawable of a picture.
struct Item {
  const Drawable* drawable;
  double distance;        // of that sphere from the camera, negative inside
  Eigen::Matrix4d model;  // to axes of the world, relative to the camera
};

class SurfacePass {
 public:
  SurfacePass(const gl::Functions& gl, GpuStore& store, const ShadowMap& shadow) : gl_(gl), store_(store), shadow_(shadow) {}

  void begin(const Picture& picture);
  base::Result<void> draw(const Item& item);
  // Another program has been in use since the last draw().
  void resume() { current_ = nullptr; }

 private:
  void tell_view(const SurfaceProgram& program);
  void tell_suns(const SurfaceProgram& program);
  void tell_lamps(const SurfaceProgram& program, const std::vector<Lamp>& lamps);
  void tell_mark(const SurfaceProgram& program, const Drawable& drawable);
  void tell_material(const SurfaceProgram& program, const Drawable& drawable);

  const gl::Functions& gl_;
  GpuStore& store_;
  const ShadowMap& shadow_;
  std::optional<Picture> picture_;
  SurfaceProgram* current_ = nullptr;
  const Material* told_material_ = nullptr;
  std::uint64_t frame_ = 0;
};

}  // namespace sim
