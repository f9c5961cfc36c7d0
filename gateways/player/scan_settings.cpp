#include "scan_settings.h"

#include <algorithm>
#include <cmath>

#include "device.h"

namespace gateway {
namespace {

constexpr double tolerance = 1e-3;  // of a beam's step, a rate, a range: clients send floats

double angle_step(const shm::LaserInfo& info) { return info.angle_step > 0 ? info.angle_step : 1e-3; }  // clients divide by it

// How many times `unit` goes into `value`, if that is a whole number from 1 on.
std::optional<std::uint64_t> multiple(double value, double unit) {
  const double count = std::round(value / unit);
  if (!(count >= 1 && count < 1e9) || std::abs(value / unit - count) > tolerance * count) return std::nullopt;
  return static_cast<std::uint64_t>(count);
}

bool is_within(double value, double low, double high) {
  const double slack = tolerance * std::max(1.0, std::abs(high));
  return value >= low - slack && value <= high + slack;
}

bool is_finite(const ScanSettings& s) {
  const auto all = {s.min_angle, s.max_angle, s.resolution, s.min_range, s.max_range, s.range_resolution, s.rate};
  return std::all_of(all.begin(), all.end(), [](double value) { return std::isfinite(value); });
}

}  // namespace

ScanFilter::ScanFilter(const shm::LaserInfo& info) : beams_(info.beams) {
  settings_.min_angle = info.min_angle;
  settings_.max_angle = info.max_angle;
  settings_.resolution = angle_step(info);
  settings_.min_range = info.min_range;
  settings_.max_range = info.max_range;
  settings_.range_resolution = info.range_step;
  settings_.rate = info.rate;
}

std::optional<ScanFilter> ScanFilter::choose(const shm::LaserInfo& info, const ScanSettings& wanted) {
  ScanFilter filter(info);
  ScanSettings& now = filter.settings_;
  if (!is_finite(wanted)) return std::nullopt;
  if (wanted.resolution != 0) {
    const auto step = multiple(wanted.resolution, now.resolution);
    if (!step) return std::nullopt;
    filter.step_ = static_cast<std::size_t>(*step);
  }
  std::size_t last = info.beams > 0 ? info.beams - 1 : 0;
  if (wanted.min_angle != 0 || wanted.max_angle != 0) {
    if (wanted.min_angle > wanted.max_angle || !is_within(wanted.min_angle, info.min_angle, info.max_angle) ||
        !is_within(wanted.max_angle, info.min_angle, info.max_angle))
      return std::nullopt;
    const auto beam_at = [&](double angle) {
      return std::clamp(std::round((angle - info.min_angle) / now.resolution), 0.0, static_cast<double>(last));
    };
    filter.first_ = static_cast<std::size_t>(beam_at(wanted.min_angle));
    last = static_cast<std::size_t>(beam_at(wanted.max_angle));
  }
  filter.beams_ = info.beams > 0 ? (last - filter.first_) / filter.step_ + 1 : 0;
  if (wanted.rate != 0) {
    // Every n-th scan: the rate that is asked for, or the next one above it.
    if (!(wanted.rate > 0) || wanted.rate > info.rate * (1 + tolerance)) return std::nullopt;
    filter.every_scan_ = static_cast<std::uint64_t>(std::clamp(std::floor(info.rate / wanted.rate * (1 + tolerance)), 1.0, 1e9));
  }
  if (wanted.range_resolution != 0) {
    if (!(wanted.range_resolution > 0) || wanted.range_resolution < info.range_step * (1 - tolerance)) return std::nullopt;
    now.range_resolution = wanted.range_resolution;
    if (wanted.range_resolution > info.range_step * (1 + tolerance)) filter.quantum_ = wanted.range_resolution;
  }
  if (wanted.min_range != 0 && !is_within(wanted.min_range, info.min_range, info.max_range)) return std::nullopt;
  if (wanted.max_range != 0 && !is_within(wanted.max_range, info.min_range, info.max_range)) return std::nullopt;
  if (wanted.min_range != 0) now.min_range = wanted.min_range;
  if (wanted.max_range != 0) now.max_range = wanted.max_range;
  if (now.min_range > now.max_range) return std::nullopt;
  if (filter.beams_ != info.beams) {
    const double step = now.resolution;
    now.resolution = step * static_cast<double>(filter.step_);
    now.min_angle = info.min_angle + step * static_cast<double>(filter.first_);
    now.max_angle = filter.beams_ > 1 ? now.min_angle + now.resolution * static_cast<double>(filter.beams_ - 1) : now.min_angle;
  }
  now.rate = info.rate / static_cast<double>(filter.every_scan_);
  return filter;
}

std::vector<float> ScanFilter::values(std::span<const float> all) const {
  std::vector<float> shown;
  shown.reserve(beams_);
  for (std::size_t i = first_; i < all.size() && shown.size() < beams_; i += step_) shown.push_back(all[i]);
  return shown;
}

std::vector<float> ScanFilter::ranges(std::span<const float> all) const {
  auto shown = values(all);
  for (float& range : shown) {
    double seen = seen_range(range, settings_.min_range, settings_.max_range);
    if (quantum_ > 0) seen = std::min(std::round(seen / quantum_) * quantum_, settings_.max_range);
    range = static_cast<float>(seen);
  }
  return shown;
}

std::span<const float> level_layer(const shm::LaserInfo& info, std::span<const float> values) {
  std::size_t layer = 0;
  if (info.layers > 1 && info.max_vertical > info.min_vertical) {
    const double step = (info.max_vertical - info.min_vertical) / (info.layers - 1);
    layer = static_cast<std::size_t>(std::clamp(std::round(-info.min_vertical / step), 0.0, static_cast<double>(info.layers - 1)));
  }
  const std::size_t first = std::min(layer * info.beams, values.size());
  return values.subspan(first, std::min<std::size_t>(info.beams, values.size() - first));
}

}  // namespace gateway
