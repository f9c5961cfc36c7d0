// Labels of models and actors, and ranges of thermal cameras: the plugins Label and ThermalSensor of gz-sim. build_visual (model_builder.h)
// reads those of visuals. One thread at a time.
#pragma once

#include <cstdint>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "world/complaints.h"
#include "world/world_def.h"

namespace sim {

// Of the model (of actors: the scope is empty), 1..255, or 0 without such a plugin.
std::uint8_t label_of(const std::vector<PluginDef>& plugins, const std::string& scope);

// Visuals without a label of their own have that of the nearest model around them.
void inherit_labels(ModelDef& model);

// The range of a thermal camera, from its plugin ThermalSensor; a range that cannot be is reported.
void read_thermal_sensor(pugi::xml_node node, const PluginDef& plugin, ThermalDef& thermal, Complaints& complaints);

}  // namespace sim
