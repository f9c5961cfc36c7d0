#include "scan_features.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace iface {
namespace {

struct Run {
  std::size_t first, last;  // both belong to it
  std::size_t size() const { return last - first + 1; }
};

struct Line {
  Run run;
  double rho, alpha;  // of the normal
  double variance_rho, variance_alpha;
  ScanPoint start, end;
};

double distance(const ScanPoint& a, const ScanPoint& b) { return std::hypot(a.x - b.x, a.y - b.y); }

class Finder {
 public:
  Finder(std::span<const ScanPoint> scan, const FeatureLimits& limits) : scan_(scan), limits_(limits) {}

  std::vector<Line> lines() {
    for (std::size_t i = 0; i < scan_.size();) {
      if (!scan_[i].is_hit) {
        ++i;
        continue;
      }
      std::size_t last = i;
      while (last + 1 < scan_.size() && scan_[last + 1].is_hit && distance(scan_[last], scan_[last + 1]) <= limits_.gap) ++last;
      split({i, last});
      i = last + 1;
    }
    return std::move(lines_);
  }

 private:
  void split(const Run& run) {
    if (run.size() < static_cast<std::size_t>(limits_.points)) return;
    const ScanPoint &a = scan_[run.first], &b = scan_[run.last];
    const double length = std::max(distance(a, b), 1e-9);
    std::size_t furthest = run.first;
    double most = 0;
    for (std::size_t i = run.first + 1; i < run.last; ++i) {
      const double off = std::abs((b.x - a.x) * (a.y - scan_[i].y) - (a.x - scan_[i].x) * (b.y - a.y)) / length;
      if (off > most) most = off, furthest = i;
    }
    if (most > limits_.distance) {
      split({run.first, furthest});
      split({furthest, run.last});
      return;
    }
    lines_.push_back(fit(run));
  }

  // Least squares across the line.
  Line fit(const Run& run) const {
    const auto count = static_cast<double>(run.size());
    double x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    for (std::size_t i = run.first; i <= run.last; ++i) x += scan_[i].x / count, y += scan_[i].y / count;
    for (std::size_t i = run.first; i <= run.last; ++i) {
      const double dx = scan_[i].x - x, dy = scan_[i].y - y;
      xx += dx * dx, yy += dy * dy, xy += dx * dy;
    }
    Line line{run, 0, std::atan2(-2 * xy, yy - xx) / 2, 0, 0, {}, {}};
    line.rho = x * std::cos(line.alpha) + y * std::sin(line.alpha);
    if (line.rho < 0) line.rho = -line.rho, line.alpha = std::remainder(line.alpha + M_PI, 2 * M_PI);
    line.variance_rho = limits_.noise * limits_.noise / count;
    line.variance_alpha = limits_.noise * limits_.noise / std::max(xx + yy, 1e-12);
    line.start = onto(line, scan_[run.first]);
    line.end = onto(line, scan_[run.last]);
    return line;
  }

  static ScanPoint onto(const Line& line, const ScanPoint& p) {
    const double c = std::cos(line.alpha), s = std::sin(line.alpha), off = p.x * c + p.y * s - line.rho;
    return {p.x - off * c, p.y - off * s, true};
  }

  std::span<const ScanPoint> scan_;
  const FeatureLimits& limits_;
  std::vector<Line> lines_;
};

// Where two lines that follow each other meet, if both end there.
std::optional<ScanPoint> corner_of(const Line& a, const Line& b, double most) {
  const double turn = std::sin(b.alpha - a.alpha);
  if (std::abs(turn) < 0.2) return std::nullopt;
  const ScanPoint corner{(a.rho * std::sin(b.alpha) - b.rho * std::sin(a.alpha)) / turn,
                         (b.rho * std::cos(a.alpha) - a.rho * std::cos(b.alpha)) / turn, true};
  const bool is_there = distance(corner, a.end) <= 2 * most && distance(corner, b.start) <= 2 * most;
  return is_there ? std::optional(corner) : std::nullopt;
}

// Behind the end of a line lies what is further away, or nothing: the line ends there itself.
bool is_sighted(std::span<const ScanPoint> scan, std::size_t end, bool forward) {
  if (forward ? end + 1 >= scan.size() : end == 0) return false;
  const ScanPoint& next = scan[forward ? end + 1 : end - 1];
  return !next.is_hit || std::hypot(next.x, next.y) > std::hypot(scan[end].x, scan[end].y);
}

RTC::LineFeature to_feature(const Line& line, bool start_sighted, bool end_sighted) {
  RTC::LineFeature feature{};
  feature.probability = 1;
  feature.rho = line.rho;
  feature.alpha = line.alpha;
  feature.covariance = {line.variance_rho, 0, line.variance_alpha};
  feature.start = {line.start.x, line.start.y};
  feature.end = {line.end.x, line.end.y};
  feature.startSighted = start_sighted;
  feature.endSighted = end_sighted;
  return feature;
}

}  // namespace

void find_features(std::span<const ScanPoint> scan, const FeatureLimits& limits, RTC::Features& features) {
  const auto lines = Finder(scan, limits).lines();
  features.lineFeatures.length(static_cast<CORBA::ULong>(lines.size()));
  features.pointFeatures.length(0);
  features.poseFeatures.length(0);
  bool begins_in_corner = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    const auto corner = i + 1 < lines.size() ? corner_of(line, lines[i + 1], std::max(limits.distance, limits.gap)) : std::nullopt;
    features.lineFeatures[static_cast<CORBA::ULong>(i)] =
        to_feature(line, begins_in_corner || is_sighted(scan, line.run.first, false), corner || is_sighted(scan, line.run.last, true));
    begins_in_corner = corner.has_value();
    if (!corner) continue;
    const double variance = line.variance_rho + lines[i + 1].variance_rho;
    const CORBA::ULong count = features.pointFeatures.length();
    features.pointFeatures.length(count + 1);
    features.pointFeatures[count] = {1, {corner->x, corner->y}, {variance, 0, variance}};
  }
}

}  // namespace iface
