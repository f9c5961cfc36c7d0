// Simulated time for clients: greater than 0 and never decreasing, also after a reset of the simulation or a restart of the simulator.
// Values; one thread at a time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace gateway {

class Timeline {
 public:
  // [s] of a sample. `server` counts the simulators that were met, `resets` those of the world. Nothing for a sample from before the last
  // reset.
  std::optional<double> at(std::uint64_t server, std::uint32_t resets, std::int64_t sim_time_ns) {
    const std::pair run(server, resets);
    if (run < run_) return std::nullopt;
    if (run > run_) {
      run_ = run;
      start_ = latest_;
    }
    const double time = start_ + static_cast<double>(sim_time_ns) / 1e9;
    latest_ = std::max(latest_, time);
    return time;
  }
  // A device had to stamp a sample later than at() said.
  void note(double time) { latest_ = std::max(latest_, time); }
  // The latest time that was seen.
  double latest() const { return latest_; }

 private:
  std::pair<std::uint64_t, std::uint32_t> run_{0, 0};
  double start_ = 0;
  double latest_ = 0;
};

}  // namespace gateway
