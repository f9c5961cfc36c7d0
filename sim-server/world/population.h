// Poses of the models of a <population>. Any thread.
#pragma once

#include <Eigen/Geometry>
#include <pugixml.hpp>
#include <vector>

#include "world/complaints.h"

namespace sim {

// Poses in the frame of the population: `model_count` of them, or rows x columns of a grid, within the box or cylinder that the population
// names. Random ones depend on its name alone, so that they are the same in every run. Empty, with a finding, when the numbers make no
// sense.
std::vector<Eigen::Isometry3d> places_of(pugi::xml_node population, Complaints& complaints);

}  // namespace sim
