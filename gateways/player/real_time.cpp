#include "real_time.h"

#include <algorithm>

namespace gateway {

void RealTime::begin(Time now, Duration age, bool is_paused, bool has_run) {
  start_ = now - std::max(age, Duration{});
  paused_ = {};
  paused_since_.reset();
  if (is_paused) paused_since_ = has_run ? now : start_;
}

void RealTime::see(Time now, bool is_paused, Duration said) {
  if (is_paused && !paused_since_) paused_since_ = std::max(start_, now - std::max(said, Duration{}));
  if (is_paused || !paused_since_) return;
  paused_ += now - *paused_since_;
  paused_since_.reset();
}

}  // namespace gateway
