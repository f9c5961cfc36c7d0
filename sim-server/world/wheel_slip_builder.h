// Reads the plugin WheelSlip of gz-sim and Gazebo classic: which wheels slip, and how much. A wheel that does not exist, or without a
// positive force or radius, is left out with a line. Any thread.
#pragma once

#include <pugixml.hpp>
#include <string>

#include "world/complaints.h"
#include "world/world_def.h"

namespace sim {

// `model` has all links of this scope already.
void add_wheel_slips(pugi::xml_node plugin, const std::string& scope, ModelDef& model, Complaints& complaints);

}  // namespace sim
