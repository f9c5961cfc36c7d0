// The occupancy map of a world, made from the simulator's export of the shapes that collide. Any thread, one at a time for a requester.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "shm/map_lines.h"
#include "shm/occupancy.h"
#include "shm/request_board.h"

namespace shm {

struct MapOptions {
  double resolution = 0.05;                   // [m] a side of a cell
  std::vector<double> heights = {0.05, 0.5};  // [m] what is between these counts
  std::vector<double> area;                   // xmin, ymin, xmax, ymax [m]; empty: where something is
  bool with_movable = false;                  // models that can move, too
  std::vector<std::array<double, 2>> places;  // x, y that the map has, too, where no area is given; with them, nothing else has to be there
  int max_cells = 8192;                       // a side
  bool may_coarsen = false;                   // cells grow where there would be more of them, instead of an error
};

struct WorldMap {
  MapArea area;
  std::vector<std::uint8_t> pixels;  // as OccupancyMap::pixels
  std::vector<MapLine> lines;        // outlines of the same shapes, in the middle between the heights
};

// `glb`: the reply to an ExportRequest with collisions. Fails when nothing is between the heights, or the map would have too many cells a
// side.
base::Result<WorldMap> make_map(const std::string& glb, const MapOptions& options);
base::Result<WorldMap> world_map(Requester& requester, const MapOptions& options, std::chrono::nanoseconds timeout);

}  // namespace shm
