// Real time since the start of a simulator, and the part of it in which the simulator was paused, as the gateway observed it: from its
// first connection on, and before that if the simulator had never run. One thread at a time.
#pragma once

#include <chrono>
#include <optional>

namespace gateway {

class RealTime {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  // A simulator was met, `age` after its start.
  void begin(Time now, Duration age, bool is_paused, bool has_run);
  // Its clock says so, since `said` ago.
  void see(Time now, bool is_paused, Duration said);

  // [s]
  double since_start(Time now) const { return seconds(now - start_); }
  double paused(Time now) const { return seconds(paused_ + (paused_since_ ? now - *paused_since_ : Duration{})); }

 private:
  static double seconds(Duration time) { return std::chrono::duration<double>(time).count(); }
  Time start_;
  Duration paused_{};
  std::optional<Time> paused_since_;
};

}  // namespace gateway
