// Compares simulated time with wall-clock time: when a step is due, the real-time factor of the run, and the fraction of time that it
// works. It reads no clock itself. The stepping thread only.
#pragma once

#include <chrono>
#include <optional>

namespace sim {

class Pace {
 public:
  using Wall = std::chrono::steady_clock::time_point;

  // `wanted`: seconds of simulated time in a second of the wall; 0: as fast as possible.
  explicit Pace(double wanted) : wanted_(wanted) {}

  double wanted() const { return wanted_; }
  void want(double factor) { wanted_ = factor; }
  bool is_free() const { return wanted_ <= 0; }

  // Time goes on from here: what came before is neither caught up nor complained about.
  void start(Wall now, std::chrono::nanoseconds simulated);
  // When it is to be so late in the simulation. None while it is free, and when it has fallen far behind: what is lost is lost, or a fast
  // stretch would follow each slow one.
  std::optional<Wall> due(Wall now, std::chrono::nanoseconds simulated);

  // The run waited for the wall.
  void add_sleep(std::chrono::nanoseconds slept) { slept_ += slept; }
  // True about once a second; reached() and load() are then those of the last second.
  bool measure(Wall now, std::chrono::nanoseconds simulated);
  // Simulated time has jumped: the measurement begins anew.
  void restart_measurement(Wall now, std::chrono::nanoseconds simulated);
  double reached() const { return reached_; }
  double load() const { return load_; }
  // What it has reached in the last ten seconds, once for each ten in which that was less than what was wanted.
  std::optional<double> shortfall(Wall now, std::chrono::nanoseconds simulated);

 private:
  struct Mark {
    Wall wall{};
    std::chrono::nanoseconds simulated{0};
    // Simulated seconds in a second of the wall since then.
    double rate(Wall now, std::chrono::nanoseconds simulated_now) const;
  };
  double wanted_;
  Mark pace_, measured_, watched_;
  std::chrono::nanoseconds slept_{0};
  double reached_ = 0, load_ = 0;
};

}  // namespace sim
