// Small worlds for tests of pictures.
#pragma once

#include <string>

#include "render/renderer.h"
#include "world/world_def.h"

namespace sim::test {

inline MaterialDef plain_material(const Color& diffuse) {
  MaterialDef material;
  material.diffuse = diffuse;
  return material;
}

// Looks like its colour whatever the light.
inline MaterialDef glowing_material(const Color& color) {
  MaterialDef material;
  material.diffuse = {0, 0, 0, 1};
  material.emissive = color;
  material.lighting = false;
  return material;
}

inline ModelDef one_visual_model(const std::string& name, const GeometryDef& geometry, const Eigen::Isometry3d& pose,
                                 const MaterialDef& material, bool is_static = true) {
  ModelDef model;
  model.name = name;
  model.pose = pose;
  model.is_static = is_static;
  model.canonical_link = "link";
  LinkDef link;
  link.name = "link";
  VisualDef visual;
  visual.name = "visual";
  visual.geometry = geometry;
  visual.material = material;
  link.visuals.push_back(visual);
  model.links.push_back(link);
  return model;
}

inline Eigen::Isometry3d at(double x, double y, double z, double yaw = 0, double pitch = 0, double roll = 0) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  pose.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
              Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()));
  return pose;
}

inline LightDef sun(const Eigen::Vector3d& direction, const Color& color, bool casts_shadows) {
  LightDef light;
  light.kind = LightDef::Kind::directional;
  light.direction = direction.normalized();
  light.diffuse = color;
  light.specular = {0, 0, 0, 1};
  light.cast_shadows = casts_shadows;
  return light;
}

// Black, without ambient light.
inline WorldDef dark_world() {
  WorldDef world;
  world.scene.ambient = {0, 0, 0, 1};
  world.scene.background = {0, 0, 0, 1};
  return world;
}

}  // namespace sim::test
