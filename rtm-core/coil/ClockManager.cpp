#include "coil/ClockManager.h"

namespace coil {
namespace {

TimeValue now() { return TimeValue(std::chrono::system_clock::now().time_since_epoch()); }

}  // namespace

TimeValue SystemClock::gettime() const { return now(); }
bool SystemClock::settime(TimeValue /*clocktime*/) { return false; }

TimeValue LogicalClock::gettime() const {
  std::lock_guard lock(mutex_);
  return time_;
}

bool LogicalClock::settime(TimeValue clocktime) {
  std::lock_guard lock(mutex_);
  time_ = clocktime;
  return true;
}

TimeValue AdjustedClock::gettime() const {
  std::lock_guard lock(mutex_);
  return now() - offset_;
}

bool AdjustedClock::settime(TimeValue clocktime) {
  std::lock_guard lock(mutex_);
  offset_ = now() - clocktime;
  return true;
}

IClock& ClockManager::getClock(const std::string& clocktype) {
  if (clocktype == "logical") return logical_;
  if (clocktype == "adjusted") return adjusted_;
  return system_;
}

}  // namespace coil
