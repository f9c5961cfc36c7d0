// Prepares a URDF robot for libsdformat: corrects what that library translates wrongly, and gives a reason for what it rejects without one.
// Pure; any thread.
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string>

#include "world/complaints.h"

namespace sim {

// Removes the <inertial> of links without mass that a fixed joint holds. The library divides by the mass of such a link and what it hangs
// on.
void mend_urdf(pugi::xml_node robot);

// Puts the <mimic> of joints, which the library leaves out in silence, into its translation. A finding for each that means nothing.
void carry_mimics(pugi::xml_node robot, pugi::xml_node sdf, Complaints& complaints);

// The first thing in it that URDF does not allow; in lower case, no full stop.
std::optional<std::string> fault_of_urdf(pugi::xml_node robot);

}  // namespace sim
