#include "shm/map_path.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <utility>

#include "base/text.h"

namespace shm {
namespace {

constexpr float far_away = std::numeric_limits<float>::infinity();

// Distances of the cells of one line to the nearest one that is at distance 0, squared: the lower envelope of parabolas.
void squared_distances(std::vector<float>& line, std::vector<float>& out, std::vector<int>& places, std::vector<float>& borders) {
  const int count = static_cast<int>(line.size());
  int last = -1;
  for (int q = 0; q < count; ++q) {
    if (line[static_cast<std::size_t>(q)] == far_away) continue;
    float from = -far_away;
    while (last >= 0) {
      const int p = places[static_cast<std::size_t>(last)];
      const float fq = line[static_cast<std::size_t>(q)] + static_cast<float>(q) * static_cast<float>(q);
      const float fp = line[static_cast<std::size_t>(p)] + static_cast<float>(p) * static_cast<float>(p);
      from = (fq - fp) / static_cast<float>(2 * (q - p));
      if (from > borders[static_cast<std::size_t>(last)]) break;
      --last;
      from = -far_away;
    }
    ++last;
    places[static_cast<std::size_t>(last)] = q;
    borders[static_cast<std::size_t>(last)] = from;
  }
  for (int q = 0, k = 0; q < count; ++q) {
    if (last < 0) {
      out[static_cast<std::size_t>(q)] = far_away;
      continue;
    }
    while (k < last && borders[static_cast<std::size_t>(k) + 1] < static_cast<float>(q)) ++k;
    const int p = places[static_cast<std::size_t>(k)];
    out[static_cast<std::size_t>(q)] = static_cast<float>((q - p) * (q - p)) + line[static_cast<std::size_t>(p)];
  }
}

// The map as distances to what is occupied, and the search on it.
class Ways {
 public:
  Ways(const WorldMap& map, double radius);

  bool is_free(std::size_t cell) const { return clearance_[cell] >= radius_; }
  std::size_t cell_of(const MapPlace& place) const;
  MapPlace place_of(std::size_t cell) const;
  // Cells from the goal to the start; empty: nothing leads there.
  std::vector<std::size_t> search(std::size_t start, std::size_t goal) const;
  // A robot can go straight from one cell to the other, and nearer to nothing than it is allowed (`margin` more than its radius).
  bool is_straight(std::size_t a, std::size_t b, float margin) const;
  float clearance(std::size_t cell) const { return clearance_[cell]; }

 private:
  float cost(std::size_t cell) const;

  const MapArea& area_;
  const std::size_t width_, height_;
  const float radius_;            // [cell]
  std::vector<float> clearance_;  // [cell]
};

Ways::Ways(const WorldMap& map, double radius)
    : area_(map.area),
      width_(static_cast<std::size_t>(map.area.width)),
      height_(static_cast<std::size_t>(map.area.height)),
      radius_(static_cast<float>(radius / map.area.resolution)),
      clearance_(width_ * height_) {
  std::vector<float> line, out;
  std::vector<int> places(std::max(width_, height_) + 1);
  std::vector<float> borders(places.size());
  for (std::size_t row = 0; row < height_; ++row) {  // rows of pixels begin at the highest y
    for (std::size_t column = 0; column < width_; ++column)
      clearance_[row * width_ + column] = map.pixels[(height_ - 1 - row) * width_ + column] == 0 ? 0 : far_away;
  }
  line.resize(height_), out.resize(height_);
  for (std::size_t column = 0; column < width_; ++column) {
    for (std::size_t row = 0; row < height_; ++row) line[row] = clearance_[row * width_ + column];
    squared_distances(line, out, places, borders);
    for (std::size_t row = 0; row < height_; ++row) clearance_[row * width_ + column] = out[row];
  }
  line.resize(width_), out.resize(width_);
  for (std::size_t row = 0; row < height_; ++row) {
    std::copy_n(clearance_.begin() + static_cast<std::ptrdiff_t>(row * width_), width_, line.begin());
    squared_distances(line, out, places, borders);
    // A cell is as near as its border.
    for (std::size_t column = 0; column < width_; ++column) clearance_[row * width_ + column] = std::sqrt(out[column]) - 0.5F;
  }
}

std::size_t Ways::cell_of(const MapPlace& place) const {
  const auto index = [&](double value, double origin, std::size_t count) {
    return static_cast<std::size_t>(std::clamp(std::floor((value - origin) / area_.resolution), 0.0, static_cast<double>(count - 1)));
  };
  return index(place[1], area_.y, height_) * width_ + index(place[0], area_.x, width_);
}

MapPlace Ways::place_of(std::size_t cell) const {
  return {area_.x + (static_cast<double>(cell % width_) + 0.5) * area_.resolution,
          area_.y + (static_cast<double>(cell / width_) + 0.5) * area_.resolution};
}

// Of a step into a cell: more where it is narrow. A robot that is in something already pays much, and so leaves by the shortest way.
float Ways::cost(std::size_t cell) const {
  constexpr float in_something = 50, wide = 2;
  const float clearance = clearance_[cell];
  if (clearance < radius_) return in_something;
  return 1 + std::max(0.0F, wide - clearance / radius_);
}

std::vector<std::size_t> Ways::search(std::size_t start, std::size_t goal) const {
  using Entry = std::pair<float, std::uint32_t>;
  std::vector<float> spent(clearance_.size(), far_away);
  std::vector<std::uint32_t> before(clearance_.size(), std::numeric_limits<std::uint32_t>::max());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto left = [&](std::size_t cell) {
    const auto dx = static_cast<float>(cell % width_) - static_cast<float>(goal % width_);
    const auto dy = static_cast<float>(cell / width_) - static_cast<float>(goal / width_);
    return std::sqrt(dx * dx + dy * dy);
  };
  spent[start] = 0;
  open.emplace(left(start), static_cast<std::uint32_t>(start));
  while (!open.empty() && open.top().second != goal) {
    const auto [estimate, cell] = open.top();
    open.pop();
    if (estimate > spent[cell] + left(cell) + 1e-3F) continue;
    const std::size_t column = cell % width_, row = cell / width_;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || (dx < 0 && column == 0) || (dx > 0 && column + 1 == width_) || (dy < 0 && row == 0) ||
            (dy > 0 && row + 1 == height_))
          continue;
        const std::size_t next = (row + static_cast<std::size_t>(dy)) * width_ + column + static_cast<std::size_t>(dx);
        // Out of something, never into it.
        if (!is_free(next) && (is_free(cell) || clearance_[next] < clearance_[cell])) continue;
        const float total = spent[cell] + cost(next) * (dx != 0 && dy != 0 ? 1.41421356F : 1.0F);
        if (total >= spent[next]) continue;
        spent[next] = total;
        before[next] = static_cast<std::uint32_t>(cell);
        open.emplace(total + left(next), static_cast<std::uint32_t>(next));
      }
    }
  }
  std::vector<std::size_t> cells;
  if (open.empty()) return cells;
  for (std::size_t cell = goal; cell != start; cell = before[cell]) cells.push_back(cell);
  cells.push_back(start);
  return cells;
}

bool Ways::is_straight(std::size_t a, std::size_t b, float margin) const {
  const double ax = static_cast<double>(a % width_), ay = static_cast<double>(a / width_);
  const double bx = static_cast<double>(b % width_), by = static_cast<double>(b / width_);
  const int steps = static_cast<int>(std::ceil(2 * std::hypot(bx - ax, by - ay)));
  for (int i = 0; i <= steps; ++i) {
    const double t = steps == 0 ? 0 : static_cast<double>(i) / steps;
    const auto x = static_cast<std::size_t>(std::lround(ax + t * (bx - ax))), y = static_cast<std::size_t>(std::lround(ay + t * (by - ay)));
    if (clearance_[y * width_ + x] < radius_ + margin) return false;
  }
  return true;
}

}  // namespace

base::Result<std::vector<MapPlace>> plan_path(const WorldMap& map, const MapPlace& start, const MapPlace& goal, double radius) {
  const auto text = [](const MapPlace& place) {
    return "(" + base::format_number(std::round(place[0] * 1000) / 1000) + ", " + base::format_number(std::round(place[1] * 1000) / 1000) +
           ")";
  };
  if (map.area.width <= 0 || map.area.height <= 0) return std::vector<MapPlace>{goal};
  const Ways ways(map, radius);
  const std::size_t from = ways.cell_of(start), to = ways.cell_of(goal);
  if (!ways.is_free(to))
    return base::Error{"the goal " + text(goal) + " is nearer than " + base::format_number(radius) + " m to something"};
  const auto cells = ways.search(from, to);
  if (cells.empty()) return base::Error{"no way leads from " + text(start) + " to " + text(goal)};
  // The longest straight legs. Where there is room, they keep a part of what the search has kept.
  std::vector<MapPlace> places;
  for (std::size_t at = cells.size() - 1; at > 0;) {
    std::size_t next = at - 1;
    float narrowest = ways.clearance(cells[next]);
    for (std::size_t k = next; k-- > 0;) {
      narrowest = std::min(narrowest, ways.clearance(cells[k]));
      const float spare = 0.5F * std::max(0.0F, narrowest - static_cast<float>(radius / map.area.resolution));
      if (ways.is_straight(cells[at], cells[k], std::min(spare, 3.0F))) next = k;
    }
    at = next;
    places.push_back(at == 0 ? goal : ways.place_of(cells[at]));
  }
  if (places.empty()) places.push_back(goal);
  return places;
}

}  // namespace shm
