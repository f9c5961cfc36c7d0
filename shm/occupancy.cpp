#include "shm/occupancy.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace shm {
namespace {

using MapPolygon = std::vector<MapPoint>;

enum class MapSide { above, below };

MapPoint between(const MapPoint& a, const MapPoint& b, std::size_t axis, double at) {
  const double t = (at - a[axis]) / (b[axis] - a[axis]);
  MapPoint p;
  for (std::size_t i = 0; i < 3; ++i) p[i] = a[i] + t * (b[i] - a[i]);
  p[axis] = at;
  return p;
}

// The part of a convex polygon on one side of a plane across an axis.
MapPolygon clipped(const MapPolygon& polygon, std::size_t axis, double at, MapSide side) {
  MapPolygon out;
  const auto is_kept = [&](const MapPoint& p) { return side == MapSide::above ? p[axis] >= at : p[axis] <= at; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const MapPoint &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (is_kept(a)) out.push_back(a);
    if (is_kept(a) != is_kept(b)) out.push_back(between(a, b, axis, at));
  }
  return out;
}

std::pair<double, double> extent(const MapPolygon& polygon, std::size_t axis) {
  const auto [least, most] = std::ranges::minmax_element(polygon, {}, [&](const MapPoint& p) { return p[axis]; });
  return {(*least)[axis], (*most)[axis]};
}

// Cells as integers, without overflow for what is far away.
int cell_at(double value) { return static_cast<int>(std::clamp(std::floor(value), -1e9, 1e9)); }

}  // namespace

OccupancyMap::OccupancyMap(const MapArea& area)
    : area_(area),
      tolerance_(1e-3 * area.resolution),
      is_occupied_(static_cast<std::size_t>(area.width) * static_cast<std::size_t>(area.height)),
      has_floor_(is_occupied_.size()) {}

double OccupancyMap::line(std::size_t axis, int cell) const { return (axis == 0 ? area_.x : area_.y) + cell * area_.resolution; }

OccupancyMap::Span OccupancyMap::span_of(const MapPolygon& polygon, std::size_t axis) const {
  const auto [least, most] = extent(polygon, axis);
  const double origin = line(axis, 0);
  return {cell_at((least + tolerance_ - origin) / area_.resolution), cell_at((most - tolerance_ - origin) / area_.resolution)};
}

bool OccupancyMap::is_inside(int column, int row) const { return column >= 0 && row >= 0 && column < area_.width && row < area_.height; }

std::size_t OccupancyMap::index(int column, int row) const {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(area_.width) + static_cast<std::size_t>(column);
}

void OccupancyMap::occupy(int column, int row) {
  if (is_inside(column, row)) is_occupied_[index(column, row)] = true;
}

void OccupancyMap::mark(const MapPolygon& polygon) {
  const Span rows = span_of(polygon, 1);
  if (rows.last < rows.first) {
    const Span columns = span_of(polygon, 0);
    for (int c = std::max(columns.first, 0); c <= std::min(columns.last, area_.width - 1); ++c)
      borders_.push_back({{c, rows.last}, {c, rows.first}});
    return;
  }
  for (int r = std::max(rows.first, 0); r <= std::min(rows.last, area_.height - 1); ++r) {
    const MapPolygon strip =
        clipped(clipped(polygon, 1, line(1, r) + tolerance_, MapSide::above), 1, line(1, r + 1) - tolerance_, MapSide::below);
    if (strip.empty()) continue;
    const Span columns = span_of(strip, 0);
    if (columns.last < columns.first) borders_.push_back({{columns.last, r}, {columns.first, r}});
    for (int c = std::max(columns.first, 0); c <= std::min(columns.last, area_.width - 1); ++c) occupy(c, r);
  }
}

// Cells whose centres the polygon covers.
void OccupancyMap::mark_floor(const MapPolygon& polygon) {
  const auto [least, most] = extent(polygon, 1);
  const int first = cell_at((least - line(1, 0)) / area_.resolution), last = cell_at((most - line(1, 0)) / area_.resolution);
  for (int r = std::max(first, 0); r <= std::min(last, area_.height - 1); ++r) {
    const double centre = line(1, r) + 0.5 * area_.resolution;
    const MapPolygon cut = clipped(clipped(polygon, 1, centre, MapSide::above), 1, centre, MapSide::below);
    if (cut.empty()) continue;
    const auto [from, to] = extent(cut, 0);
    const int begin = cell_at((from - line(0, 0)) / area_.resolution + 0.5), end = cell_at((to - line(0, 0)) / area_.resolution - 0.5);
    for (int c = std::max(begin, 0); c <= std::min(end, area_.width - 1); ++c) has_floor_[index(c, r)] = true;
  }
}

void OccupancyMap::add_mesh(std::span<const MapPoint> triangles) {
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const MapPolygon triangle(triangles.begin() + static_cast<std::ptrdiff_t>(i), triangles.begin() + static_cast<std::ptrdiff_t>(i) + 3);
    const auto [least, most] = extent(triangle, 2);
    if (most > area_.low && least < area_.high)
      mark(clipped(clipped(triangle, 2, area_.low, MapSide::above), 2, area_.high, MapSide::below));
    if (least <= area_.low) mark_floor(clipped(triangle, 2, area_.low, MapSide::below));
  }
  fill(triangles);
}

// The inside, in the middle between the heights: along each row the surface leads into the shape and out of it in turn.
void OccupancyMap::fill(std::span<const MapPoint> triangles) {
  const double middle = 0.5 * (area_.low + area_.high);
  std::map<int, std::vector<double>> crossings;
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    MapPolygon cut;
    for (std::size_t k = 0; k < 3; ++k) {
      const MapPoint &a = triangles[i + k], &b = triangles[i + (k + 1) % 3];
      if ((a[2] >= middle) != (b[2] >= middle)) cut.push_back(between(a, b, 2, middle));
    }
    if (cut.size() != 2) continue;
    const MapPoint &from = cut[0][1] < cut[1][1] ? cut[0] : cut[1], &to = cut[0][1] < cut[1][1] ? cut[1] : cut[0];
    const auto row_after = [&](double y) { return cell_at(std::ceil((y - line(1, 0)) / area_.resolution - 0.5)); };
    for (int r = std::max(row_after(from[1]), 0); r < std::min(row_after(to[1]), area_.height); ++r)
      crossings[r].push_back(between(from, to, 1, line(1, r) + 0.5 * area_.resolution)[0]);
  }
  for (auto& [row, at] : crossings) fill_row(row, at);
}

// An odd number of crossings belongs to a surface that is not closed.
void OccupancyMap::fill_row(int row, std::vector<double>& crossings) {
  if (crossings.size() % 2 != 0) return;
  std::ranges::sort(crossings);
  for (std::size_t i = 0; i < crossings.size(); i += 2) {
    const double origin = line(0, 0);
    const int first = cell_at((crossings[i] - origin) / area_.resolution + 0.5);
    const int last = cell_at((crossings[i + 1] - origin) / area_.resolution - 0.5);
    for (int c = std::max(first, 0); c <= std::min(last, area_.width - 1); ++c) occupy(c, row);
  }
}

void OccupancyMap::add_plane(const MapPoint& point, const MapPoint& normal) {
  if (!(normal[2] > 1e-6)) return;
  for (int r = 0; r < area_.height; ++r) {
    for (int c = 0; c < area_.width; ++c) {
      const double x = line(0, c) + 0.5 * area_.resolution - point[0], y = line(1, r) + 0.5 * area_.resolution - point[1];
      const double z = point[2] - (normal[0] * x + normal[1] * y) / normal[2];
      if (z > area_.low) is_occupied_[index(c, r)] = true;
      has_floor_[index(c, r)] = true;
    }
  }
}

std::vector<std::uint8_t> OccupancyMap::pixels() {
  for (const auto& [a, b] : std::exchange(borders_, {})) {
    const auto is_known = [&](const std::array<int, 2>& cell) {
      return is_inside(cell[0], cell[1]) && is_occupied_[index(cell[0], cell[1])];
    };
    if (!is_known(a) && !is_known(b)) occupy(b[0], b[1]);
  }
  constexpr std::uint8_t occupied = 0, free = 254, unknown = 205;
  std::vector<std::uint8_t> out;
  out.reserve(is_occupied_.size());
  for (int r = area_.height - 1; r >= 0; --r) {
    for (int c = 0; c < area_.width; ++c) {
      const auto i = index(c, r);
      out.push_back(is_occupied_[i] ? occupied : has_floor_[i] ? free : unknown);
    }
  }
  return out;
}

}  // namespace shm
