// Names of the ifaces of sensors and drives. Names of SDFormat may hold what no file name can, be longer, and need to be unique in their
// link only; names of ifaces are unique among those of their type. Any thread.
#pragma once

#include <string>
#include <string_view>

#include "world/world_def.h"

namespace sim {

class Complaints;

// Sonars are sensors of that type, and rays whose names begin with "sonar".
bool is_sonar(const SensorDef& sensor);
// Sonars whose names begin with "sonar" form one ring, with one iface "sonar" in their (nested) model.
bool is_of_a_ring(const SensorDef& sensor);

// `name` without slashes and control characters, which become "_".
std::string without_slashes(std::string name);

// Sets `iface` of all sensors and plugins of the model; a line for each that is not scope and own name joined by "::".
void name_ifaces(ModelDef& model, Complaints& complaints);

// Model and iface joined by "::" ("pioneer2dx::laser").
std::string iface_name(const ModelDef& model, const SensorDef& sensor);
std::string iface_name(const ModelDef& model, const PluginDef& plugin);

}  // namespace sim
