#include "shm/map_lines.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

namespace shm {
namespace {

// Ends that are less than a tenth of a millimetre apart are one.
using LineEnd = std::pair<std::int64_t, std::int64_t>;
LineEnd end_at(double x, double y) {
  constexpr double parts = 1e4;  // [1/m]
  return {std::llround(x * parts), std::llround(y * parts)};
}

std::optional<MapLine> crossing(std::span<const MapPoint, 3> triangle, double height) {
  std::vector<std::pair<double, double>> ends;
  for (std::size_t k = 0; k < 3; ++k) {
    const MapPoint &a = triangle[k], &b = triangle[(k + 1) % 3];
    if ((a[2] >= height) == (b[2] >= height)) continue;
    const double t = (height - a[2]) / (b[2] - a[2]);
    ends.emplace_back(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]));
  }
  if (ends.size() != 2 || end_at(ends[0].first, ends[0].second) == end_at(ends[1].first, ends[1].second)) return std::nullopt;
  return MapLine{ends[0].first, ends[0].second, ends[1].first, ends[1].second};
}

bool is_straight_on(const MapLine& a, const MapLine& b) {
  const double ax = a.x1 - a.x0, ay = a.y1 - a.y0, bx = b.x1 - b.x0, by = b.y1 - b.y0;
  return std::abs(ax * by - ay * bx) < 1e-4 * std::hypot(ax, ay) * std::hypot(bx, by);
}

// Joins pieces at ends that exactly two of them share.
class Joiner {
 public:
  explicit Joiner(std::vector<MapLine> pieces) : pieces_(std::move(pieces)), is_used_(pieces_.size()) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      at_[end_at(pieces_[i].x0, pieces_[i].y0)].push_back(i);
      at_[end_at(pieces_[i].x1, pieces_[i].y1)].push_back(i);
    }
  }
  void append_to(std::vector<MapLine>& lines) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (is_used_[i]) continue;
      is_used_[i] = true;
      MapLine line = pieces_[i];
      grow(line, i);
      std::swap(line.x0, line.x1);
      std::swap(line.y0, line.y1);
      grow(line, i);
      lines.push_back(line);
    }
  }

 private:
  // At the second end, by one piece after another.
  void grow(MapLine& line, std::size_t last) {
    while (true) {
      const auto& here = at_[end_at(line.x1, line.y1)];
      if (here.size() != 2) return;
      const std::size_t next = here[0] == last ? here[1] : here[0];
      if (is_used_[next] || !is_straight_on(line, pieces_[next])) return;
      const MapLine& piece = pieces_[next];
      const bool is_forward = end_at(piece.x0, piece.y0) == end_at(line.x1, line.y1);
      line.x1 = is_forward ? piece.x1 : piece.x0;
      line.y1 = is_forward ? piece.y1 : piece.y0;
      is_used_[next] = true;
      last = next;
    }
  }

  std::vector<MapLine> pieces_;
  std::vector<bool> is_used_;
  std::map<LineEnd, std::vector<std::size_t>> at_;
};

}  // namespace

void add_map_lines(std::span<const MapPoint> triangles, double height, std::vector<MapLine>& lines) {
  std::vector<MapLine> pieces;
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    if (const auto piece = crossing(triangles.subspan(i).first<3>(), height)) pieces.push_back(*piece);
  }
  Joiner(std::move(pieces)).append_to(lines);
}

}  // namespace shm
