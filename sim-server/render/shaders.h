// The GLSL that draws, and the formula of its light. A program is made for each set of features that occurs, so nothing is paid for what a
// surface does not have. Values; any thread.
//
// The formula. Colours of materials, textures, background, fog and scene ambient are sRGB and turned into linear light first; colours of
// lights are linear light already. For a point p with unit normal n, seen from direction v (from p to the eye):
//
//   diffuse  = ambient * (1 + 0.25 n.z) + sum over lights of  L * max(0, n.l)
//   specular = sum over lights of  L.specular * material.specular * max(0, n.h)^shininess    with h = (l + v) / |l + v|, where n.l > 0
//   linear   = emissive + material diffuse * toned + specular         materials without lighting: emissive + material diffuse
//   toned    = min(diffuse, 1.2 - 0.2 / max(diffuse, 1)), for each colour: light above 1 counts little, so that paint under many lamps
//              keeps its colour and what shade it has
//              with a texture: min(1, emissive + material diffuse * diffuse) * texture + specular, so that no light makes a picture
//              brighter than it is; an emissive map stays outside of that
//   L        = light diffuse * intensity * reach * shade
//   reach    = 1 (directional);  within the range 1 / (constant + linear d + quadratic d^2), else 0 (point and spot);  a spot's is times
//              clamp((cos a - cos(outer / 2)) / (cos(inner / 2) - cos(outer / 2)), 0, 1)^falloff,  a: off the spot's axis
//   shade    = share of the point that the first shadow-casting directional light reaches; 1 for all other lights
//   picture  = sRGB(mix(linear, fog, f))   f = linear: (d - start) / (end - start); exponential: 1 - exp(-density d);
//                                              quadratic: 1 - exp(-(density d)^2)        with d = |v|
//
// A material's own ambient colour is not used: a surface reflects ambient light with the same colour as all other light.
#pragma once

#include <compare>
#include <string>

#include "render/mesh.h"

namespace sim {

enum class FogKind { none, linear, exponential, quadratic };

struct Features {
  bool depth_only = false;  // no colour; shadow maps and depth cameras
  bool marks = false;       // a colour that names the visual, untouched by light
  bool signature = false;   // of marks: the texture's grey beside it
  bool texture = false;
  bool holes = false;  // of the texture: cut out
  bool normal_map = false;
  bool emissive_map = false;
  bool lit = true;
  bool specular = false;
  int shine = 0;  // the exponent when it is a whole number up to 128, else 0
  bool double_sided = false;
  bool faceted = false;               // every triangle has one normal
  RoundKind round = RoundKind::none;  // not none: met where it really is, not where its triangles are
  bool grid = false;                  // metre lines on the ground
  FogKind fog = FogKind::none;
  int shadow_taps = 0;  // a side; 0: no shadow
  int directional = 0, points = 0, spots = 0;

  auto operator<=>(const Features&) const = default;
};

std::string surface_vertex_source(const Features& features);
std::string surface_fragment_source(const Features& features);

// A triangle over all the picture at the far end, with the direction in the world that each pixel looks to.
std::string sky_vertex_source();
std::string sky_fragment_source();

// Coloured triangles in camera-relative or screen coordinates.
std::string overlay_vertex_source();
std::string overlay_fragment_source();

}  // namespace sim
