// Outlines of shapes on a map: where their triangles cross a height. Values; any thread.
#pragma once

#include <span>
#include <vector>

#include "shm/occupancy.h"

namespace shm {

struct MapLine {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // [m]
};

// Appends the outline of one shape: three points for each triangle. Lines that go straight on are one.
void add_map_lines(std::span<const MapPoint> triangles, double height, std::vector<MapLine>& lines);

}  // namespace shm
