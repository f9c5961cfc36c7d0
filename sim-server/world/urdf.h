// Prepares a URDF robot for libsdformat: corrects what that library translates wrongly, and gives a reason for what it rejects without one.
// Pure; any thread.
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string>

#include "world/complaints.h"

namespace sim {

// The robot as the library gets it. Joints on a massless link that a fixed joint holds hang on what holds it; links that move and have no
// mass get 0.1 kg, and those of less than 2e-6 kg that, with a finding; infinite limits are 1e16. Numbers of joints that mean nothing are
// replaced, with a finding. The library would leave out such links with everything on them, and reject the
// others.
std::string urdf_for_library(pugi::xml_node robot, Complaints& complaints);

// Puts the <mimic> of joints, which the library leaves out in silence, into its translation. A finding for each that means nothing.
void carry_mimics(pugi::xml_node robot, pugi::xml_node sdf, Complaints& complaints);

// The first thing in it that URDF does not allow; in lower case, no full stop.
std::optional<std::string> fault_of_urdf(pugi::xml_node robot);

}  // namespace sim
