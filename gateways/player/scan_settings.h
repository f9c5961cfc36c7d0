// The part of a scanner's scans that clients requested: a range of angles, every n-th beam, every n-th scan. Values; one thread at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "shm/iface_types.h"

namespace gateway {

// Angles [rad], ranges [m], rate [Hz].
struct ScanSettings {
  double min_angle = 0, max_angle = 0, resolution = 0, min_range = 0, max_range = 0, range_resolution = 0, rate = 0;
};

class ScanFilter {
 public:
  // All that the scanner gives.
  explicit ScanFilter(const shm::LaserInfo& info);
  // What comes nearest to `wanted` where the scanner can do it: angles and ranges within its own, steps and periods that are multiples of
  // its own, coarser ranges. 0 leaves a value (both angles 0: the angles) as the scanner has it. Nothing when it can't.
  static std::optional<ScanFilter> choose(const shm::LaserInfo& info, const ScanSettings& wanted);

  // As they are now.
  const ScanSettings& settings() const { return settings_; }
  // True once for each group of scans, by their sequence numbers, of which one is to be shown.
  bool is_due(std::uint64_t sequence) {
    const std::uint64_t group = sequence / every_scan_;
    return std::exchange(shown_group_, std::optional(group)) != group;
  }
  // Of those of the most level layer, the ones that are to be shown.
  std::vector<float> ranges(std::span<const float> all) const;
  std::vector<float> values(std::span<const float> all) const;

 private:
  ScanSettings settings_;
  std::size_t first_ = 0, step_ = 1, beams_ = 0;
  double quantum_ = 0;  // ranges are multiples of it [m]; 0: as the scanner gives them
  std::uint64_t every_scan_ = 1;
  std::optional<std::uint64_t> shown_group_;
};

// The beams of the layer that looks nearest to the horizon: Player's scanners have one.
std::span<const float> level_layer(const shm::LaserInfo& info, std::span<const float> values);

}  // namespace gateway
