// An occupancy map: which cells of the ground have something between two heights, from the triangles of shapes. Lengths in m, in the frame
// of the world. A cell is occupied if a shape overlaps it by more than a thousandth of its side; a surface without thickness that lies on
// the border of two cells occupies one of them. Closed surfaces are solid. A free cell has a surface below its centre; other cells are
// unknown. Values; one thread at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace shm {

using MapPoint = std::array<double, 3>;

struct MapArea {
  double x = 0, y = 0;  // lower left corner
  double resolution = 0.05;
  int width = 0, height = 0;      // cells
  double low = 0.05, high = 0.5;  // what is between these counts; `low` is the lower one
};

class OccupancyMap {
 public:
  explicit OccupancyMap(const MapArea& area);

  // One shape: three points for each triangle.
  void add_mesh(std::span<const MapPoint> triangles);
  // An endless plane, solid below it; `normal` points up.
  void add_plane(const MapPoint& point, const MapPoint& normal);

  // Rows from the top, a byte for each cell, as map_server reads them: 0 occupied, 254 free, 205 unknown. After the last shape.
  std::vector<std::uint8_t> pixels();

 private:
  using MapPolygon = std::vector<MapPoint>;
  struct Span {
    int first = 0, last = 0;  // last = first - 1: on the border of these two
  };
  Span span_of(const MapPolygon& polygon, std::size_t axis) const;
  double line(std::size_t axis, int cell) const;
  std::size_t index(int column, int row) const;
  bool is_inside(int column, int row) const;
  void occupy(int column, int row);
  void mark(const MapPolygon& polygon);
  void mark_floor(const MapPolygon& polygon);
  void fill(std::span<const MapPoint> triangles);
  void fill_row(int row, std::vector<double>& crossings);

  const MapArea area_;
  const double tolerance_;
  std::vector<bool> is_occupied_, has_floor_;
  std::vector<std::pair<std::array<int, 2>, std::array<int, 2>>> borders_;  // pairs of cells with a surface exactly between them
};

}  // namespace shm
