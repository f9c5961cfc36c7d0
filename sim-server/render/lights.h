// The lights and the sky of one picture, as the shaders take them: linear, relative to the camera. Values; any thread.
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "render/renderer.h"

namespace sim {

struct Sun {
  Eigen::Vector3f to_light, color, specular;
};
struct Lamp {
  Eigen::Vector3f position, color, specular;
  Eigen::Vector4f reach;  // constant, linear, quadratic attenuation, range
  bool is_spot = false;
  Eigen::Vector3f axis, cone;
  double strength = 0;  // to choose by
};

struct Lights {
  std::vector<Sun> suns;  // the one with the shadow first
  bool has_shadow = false;
  Eigen::Vector3d to_shadow_light{0, 0, 1};
  std::vector<Lamp> lamps;  // points, then spots; at most max_lamps, the strongest at the camera's place
  int points = 0, spots = 0;
  std::vector<Lamp> all;  // lamps of the scene if there are more than max_lamps, else empty
};

inline constexpr int max_lamps = 8;

Lights collect_lights(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const View& view);

// The `points` points and `spots` spots of all that are strongest at the surface of a ball (relative to the camera) [m].
std::vector<Lamp> lamps_at(const Lights& lights, const Eigen::Vector3f& centre, float radius);

struct SkyColors {
  Eigen::Vector3f zenith, horizon, ground, glow;
};

// Day, dusk and night by the hour of the scene.
SkyColors sky_colors(const SkyDef& sky);

// Linear light of an sRGB colour.
Eigen::Vector3f linear(const Color& color);

}  // namespace sim
