#include "rays/body_grid.h"

#include <algorithm>
#include <cmath>

namespace sim {
namespace {

constexpr double cell_size = 4;
constexpr double farthest_cell = 1 << 30;

std::uint32_t cell_of(double at) {
  return static_cast<std::uint32_t>(std::clamp(std::floor(at / cell_size), -farthest_cell, farthest_cell) + farthest_cell);
}

std::uint64_t cell_of(std::uint32_t row, std::uint32_t column) { return std::uint64_t{row} << 32 | column; }

}  // namespace

void BodyGrid::build(std::span<const Entry> entries) {
  placed_.clear();
  everywhere_.clear();
  largest_ = 0;
  for (const Entry& entry : entries) {
    if (!std::isfinite(entry.x + entry.y + entry.radius)) {
      everywhere_.push_back(entry.id);
      continue;
    }
    placed_.push_back({cell_of(cell_of(entry.y), cell_of(entry.x)), entry.id});
    largest_ = std::max(largest_, entry.radius);
  }
  std::ranges::sort(placed_, {}, [](const Placed& one) { return std::pair(one.cell, one.id); });
}

void BodyGrid::find(double x, double y, double reach, std::vector<std::uint32_t>& ids) const {
  ids = everywhere_;
  const double around = reach + largest_;
  if (!placed_.empty() && std::isfinite(x + y)) {
    const auto low = cell_of(x - around), high = cell_of(x + around), last = cell_of(y + around);
    auto at = placed_.begin();
    // From row to row that has something in it.
    for (std::uint32_t row = cell_of(y - around); at != placed_.end();) {
      at = std::ranges::lower_bound(at, placed_.end(), cell_of(row, low), {}, &Placed::cell);
      for (; at != placed_.end() && at->cell <= cell_of(row, high); ++at) ids.push_back(at->id);
      if (at == placed_.end()) break;
      row = std::max(row + 1, static_cast<std::uint32_t>(at->cell >> 32));
      if (row > last) break;
    }
  }
  std::ranges::sort(ids);
}

}  // namespace sim
