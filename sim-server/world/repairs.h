// Elements of a document that mean something to a person but not in SDFormat 1.9, put the way SDFormat has them: what was copied from URDF,
// left over from xacro, or comes from newer versions. Before the document is translated to the current version. One thread at a time.
#pragma once

#include <pugixml.hpp>

#include "world/complaints.h"

namespace sim {

void repair_document(pugi::xml_node sdf, Complaints& complaints);

// A <road> of a world as a static <model> in `parent`: strips along its points, round at the corners.
pugi::xml_node model_of_road(pugi::xml_node road, pugi::xml_node parent);

// Attributes that carry <inertial auto="true"> and its densities past the checks of version 1.9.
inline constexpr const char* automatic_mark = "_auto";
inline constexpr const char* density_mark = "_density";

// The same for <initial_position> of an axis, which version 1.9 does not have any more.
inline constexpr const char* initial_mark = "_initial";

}  // namespace sim
