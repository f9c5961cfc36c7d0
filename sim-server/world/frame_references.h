// References from frames and poses to each other that lead nowhere or round in a circle: libsdformat rejects all that it reads with one of
// them, so they are taken out before, with a line each. One thread at a time.
#pragma once

#include <pugixml.hpp>
#include <string>
#include <vector>

#include "world/complaints.h"

namespace sim {

// What stands in a world or model, mostly under a name of its own.
struct NamedPlace {
  std::string name;      // empty: nobody can refer to it
  pugi::xml_node frame;  // its <frame>, which may be attached to something; null for anything else
  pugi::xml_node pose;   // its <pose>, which may be relative to something; null: none
  std::string implied;   // what its pose is relative to when nothing is said (of joints: the child)
};

// The places of a world, all of them: a name that is none of theirs, with what comes before its first "::", leads nowhere.
void repair_missing_references(const std::vector<NamedPlace>& places, Complaints& complaints);

// Of each circle one reference is taken out: of the places of a world, or within a model.
void repair_circular_references(const std::vector<NamedPlace>& places, Complaints& complaints);
void repair_circular_references(pugi::xml_node model, Complaints& complaints);

}  // namespace sim
