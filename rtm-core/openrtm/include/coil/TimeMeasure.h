// Statistics over the last lengths of time between tick() and tack(). One thread at a time.
#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

#include "coil/TimeValue.h"

namespace coil {

class TimeMeasure {
 public:
  struct Statistics {  // [s]
    double max_interval = 0;
    double min_interval = 0;
    double mean_interval = 0;
    double std_deviation = 0;
  };

  // Keeps at most this many lengths.
  explicit TimeMeasure(unsigned long buflen = 100);

  void tick();
  // Does nothing before the first tick.
  void tack();
  TimeValue interval() const { return TimeValue(last_); }
  void reset();
  unsigned long count() const { return static_cast<unsigned long>(lengths_.size()); }

  // False before the first tack.
  bool getStatistics(double& max_interval, double& min_interval, double& mean_interval, double& stddev) const;
  Statistics getStatistics() const;

 private:
  std::vector<double> lengths_;  // [s]
  std::size_t capacity_;
  std::size_t next_ = 0;
  bool has_begun_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::nanoseconds last_{};
};

}  // namespace coil
