// What one would write by hand to draw a scene once more and once more: one context, one program, a shadow map made once, each drawable in
// the order it comes, the pixels read back. No culling, no sorting, nothing that moves. The measure of the renderer. One thread.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/renderer.h"

namespace bench {

class BareGl {
 public:
  // The first light of the scene must be directional. Throws std::runtime_error when OSMesa gives no context.
  BareGl(const sim::Scene& scene, std::vector<Eigen::Isometry3d> poses, int shadow_size);
  ~BareGl();

  // 4 bytes a pixel.
  void draw(const sim::View& view, std::vector<std::uint8_t>& rgba);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace bench
