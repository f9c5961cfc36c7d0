// Paths over an occupancy map, for a round robot: around occupied cells, and around corners with a margin where there is room. Pure; any
// thread.
#pragma once

#include <array>
#include <vector>

#include "base/result.h"
#include "shm/world_map.h"

namespace shm {

using MapPlace = std::array<double, 2>;  // x, y [m] in the world

// Straight legs from `start` (which is not listed) to `goal` (the last). Cells that are unknown, and all outside of the map, are free. A
// start nearer to something than `radius` [m] leaves it first. Errors: the goal is too near to something, or nothing leads there.
base::Result<std::vector<MapPlace>> plan_path(const WorldMap& map, const MapPlace& start, const MapPlace& goal, double radius);

}  // namespace shm
