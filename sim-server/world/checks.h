// Checks of a document before anything is built from it. Elements that fail are removed or corrected, with a line each. Documents are of
// the current SDFormat version. One thread at a time.
#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "world/complaints.h"

namespace sim {

// Poses, sizes, directions: rejects what is not finite, absurdly large, or not positive where it must be; the smallest object around it
// goes. False when that is the entity itself (it is still there then).
bool check_numbers(pugi::xml_node entity, Complaints& complaints);

// Names of the element and of all below it that are too long to be meant.
void check_name_lengths(pugi::xml_node entity, Complaints& complaints);

// Makes names within the model unique and legal, and takes out joints and references that lead nowhere. Includes are expanded before. False
// when the model has no link and cannot be used.
bool repair_model(pugi::xml_node model, Complaints& complaints);

// A joint may share its name with a link in files, but not in frame graphs; meanwhile it carries this ending.
inline constexpr std::string_view joint_alias_ending = "_joint_of_that_name";

}  // namespace sim
