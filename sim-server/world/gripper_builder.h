// Builds the <gripper> of a model: resolves the names of its links, which files write with the model before them or without. A gripper
// without a link that exists is left out, with a line. Any thread.
#pragma once

#include <pugixml.hpp>
#include <string>

#include "world/complaints.h"
#include "world/world_def.h"

namespace sim {

// `model` has all links of this scope already. One with <rtmsim:attach>true</rtmsim:attach> fixes to its palm what it holds.
void add_gripper(pugi::xml_node node, const std::string& scope, ModelDef& model, Complaints& complaints);

// The same of the grasp fix plugin of Gazebo classic, which files have so that what is held is fixed: <arm> with <arm_name>, <palm_link>
// and <gripper_link>s. Of a palm that has a gripper already only that it does so.
void add_grasp_fix(pugi::xml_node plugin, const std::string& scope, ModelDef& model, Complaints& complaints);

}  // namespace sim
