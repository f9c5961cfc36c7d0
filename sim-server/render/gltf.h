// A scene as glTF 2.0 binary (".glb"): for viewers that draw it themselves and receive only the poses of links. Values; any thread.
//
// Nodes: the root "world" turns our z up into glTF's y up; below it one node for each model, with one for each link ("model::link", an
// actor's bones too), with those of what hangs on it: shapes, lights, sensors. Poses of links are in the world. The scene's extras:
//   links      the nodes of the links, in the order of Scene::links
//   version    of the scene
//   ambient, background, sky, fog, shadows, grid, camera   how the world looks, as SDFormat says it; colours are sRGB
// A shape's extras: casts_shadow, ground, grid. A material is the plain one of glTF; its extras hold what our formula (render/shaders.h)
// takes: specular, shininess. A light's extras: what KHR_lights_punctual cannot say. A sensor's: iface, kind and its numbers.
// Pictures are PNG, at most 2048 pixels a side.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "render/scene.h"

namespace sim {

// A place on a link that measures.
struct GltfSensor {
  std::uint32_t link = 0;
  std::string iface, kind;
  Eigen::Isometry3d in_link = Eigen::Isometry3d::Identity();
  std::vector<std::pair<std::string, double>> numbers;  // finite ones are written
};

struct GltfWorld {
  const Scene& scene;
  std::span<const Eigen::Isometry3d> poses;  // one per link
  std::span<const GltfSensor> sensors;
  std::optional<Eigen::Isometry3d> camera;  // where the author looked from
  std::uint64_t version = 0;
};

// The octets of the file. Fails when a picture cannot be encoded.
base::Result<std::string> write_glb(const GltfWorld& world);

}  // namespace sim
