#include "coil/TimeMeasure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace coil {

TimeMeasure::TimeMeasure(unsigned long buflen) : capacity_(std::max<unsigned long>(buflen, 1)) { lengths_.reserve(capacity_); }

void TimeMeasure::tick() {
  has_begun_ = true;
  begin_ = std::chrono::steady_clock::now();
}

void TimeMeasure::tack() {
  if (!has_begun_) return;
  last_ = std::chrono::steady_clock::now() - begin_;
  const double seconds = std::chrono::duration<double>(last_).count();
  if (lengths_.size() < capacity_)
    lengths_.push_back(seconds);
  else
    lengths_[next_] = seconds;
  next_ = (next_ + 1) % capacity_;
}

void TimeMeasure::reset() {
  lengths_.clear();
  next_ = 0;
  has_begun_ = false;
  last_ = {};
}

TimeMeasure::Statistics TimeMeasure::getStatistics() const {
  Statistics s;
  if (lengths_.empty()) return s;
  const auto [min, max] = std::minmax_element(lengths_.begin(), lengths_.end());
  const double n = static_cast<double>(lengths_.size());
  s.min_interval = *min;
  s.max_interval = *max;
  s.mean_interval = std::accumulate(lengths_.begin(), lengths_.end(), 0.0) / n;
  double squares = 0;
  for (double x : lengths_) squares += (x - s.mean_interval) * (x - s.mean_interval);
  s.std_deviation = std::sqrt(squares / n);
  return s;
}

bool TimeMeasure::getStatistics(double& max_interval, double& min_interval, double& mean_interval, double& stddev) const {
  const Statistics s = getStatistics();
  max_interval = s.max_interval;
  min_interval = s.min_interval;
  mean_interval = s.mean_interval;
  stddev = s.std_deviation;
  return !lengths_.empty();
}

}  // namespace coil
