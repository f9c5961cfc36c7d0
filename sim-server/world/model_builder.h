// Definitions from the elements of a document that has been checked and whose frames are resolved. One thread at a time.
#pragma once

#include <pugixml.hpp>

#include "world/complaints.h"
#include "world/materials.h"
#include "world/sdf_library.h"
#include "world/triangles.h"
#include "world/world_def.h"

namespace sim {

struct BuildContext {
  Complaints& complaints;
  Materials& materials;
  TriangleCache triangles = {};  // of meshes that are weighed
};

// Attribute on visuals, collisions, sensors and lights whose pose is relative to a named frame: the frame of the model that stands for the
// pose.
inline constexpr const char* frame_of_pose_mark = "_frame";

// The model with its nested ones; its name and pose are as in the element and `resolved`.
ModelDef build_model(pugi::xml_node model, const ResolvedModel& resolved, BuildContext& context);

// Empty, with a finding, when there is no shape that can be simulated.
std::optional<GeometryDef> build_geometry(pugi::xml_node geometry, BuildContext& context);
// Where the shape is in its collision or visual: a flat ground instead of a height map has the height map's <pos>.
Eigen::Isometry3d ground_in_shape(pugi::xml_node geometry, const GeometryDef& built);
std::optional<VisualDef> build_visual(pugi::xml_node visual, BuildContext& context);
// `pose` is left at the raw one of the element.
std::optional<LightDef> build_light(pugi::xml_node light, BuildContext& context);
// Empty, with a finding, for a sensor of a kind that is not simulated or whose numbers make no sense.
std::optional<SensorDef> build_sensor(pugi::xml_node sensor, BuildContext& context);
PluginDef build_plugin(pugi::xml_node plugin, const std::string& scope, BuildContext& context);

// Physics, scene, lights, actors, plugins and so on: everything but the models.
WorldDef build_world(pugi::xml_node world, const ResolvedWorld& resolved, BuildContext& context);

}  // namespace sim
