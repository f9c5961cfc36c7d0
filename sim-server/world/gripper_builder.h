// Builds the <gripper> of a model: resolves the names of its links, which files write with the model before them or without. A gripper
// without a link that exists is left out, with a line. Any thread.
#pragma once

#include <pugixml.hpp>
#include <string>

#include "world/complaints.h"
#include "world/world_def.h"

namespace sim {

// `model` has all links of this scope already.
void add_gripper(pugi::xml_node node, const std::string& scope, ModelDef& model, Complaints& complaints);

}  // namespace sim
