// Shapes of bodies as Embree's geometries, and scenes made of them. Private to rays/. One thread at a time.
#pragma once

#include <string>
#include <vector>

#include "rays/embree.h"
#include "rays/ray_scene.h"

namespace sim {

struct Look {
  float retro = 0;
  std::uint32_t color = 0;
};

struct ShapeScene {
  embree::Scene scene;
  std::vector<Look> looks;  // by geometry id

  ShapeScene(RTCDevice device, RTCBuildQuality quality);
  Look look_of(unsigned geometry) const { return geometry < looks.size() ? looks[geometry] : Look(); }
  // Returns its id. With triangles that share edges the scene becomes watertight, which costs a third of its speed.
  unsigned add(const embree::Geometry& geometry, const GeometryDef& shape, const Look& look);
};

// Boxes and meshes as triangles, spheres, cylinders and capsules as what they are; not planes. Null, and a line in `notes`, when its file
// cannot be read.
embree::Geometry make_geometry(RTCDevice device, const GeometryDef& shape, const Eigen::Isometry3d& pose, TriangleCache& triangles,
                               std::vector<std::string>& notes);

// What tells shapes that look the same from those that do not.
std::string key_of(std::span<const RayShape> shapes);

}  // namespace sim
