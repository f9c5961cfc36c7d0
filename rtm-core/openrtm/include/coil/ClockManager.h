// The clocks that time stamps of the log are taken from: "system", "logical" (set by hand), "adjusted" (system plus a set difference). Any
// thread.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "coil/Singleton.h"
#include "coil/TimeValue.h"

namespace coil {

class IClock {
 public:
  virtual ~IClock() = default;
  virtual TimeValue gettime() const = 0;
  virtual bool settime(TimeValue clocktime) = 0;
};

class SystemClock : public IClock {
 public:
  TimeValue gettime() const override;
  // The clock of the computer is not ours to set: false.
  bool settime(TimeValue clocktime) override;
};

class LogicalClock : public IClock {
 public:
  TimeValue gettime() const override;
  bool settime(TimeValue clocktime) override;

 private:
  mutable std::mutex mutex_;
  TimeValue time_;
};

class AdjustedClock : public IClock {
 public:
  TimeValue gettime() const override;
  bool settime(TimeValue clocktime) override;

 private:
  mutable std::mutex mutex_;
  TimeValue offset_;
};

class ClockManager : public Singleton<ClockManager> {
 public:
  // The system clock for a name that is unknown.
  IClock& getClock(const std::string& clocktype);

 private:
  friend class Singleton<ClockManager>;
  ClockManager() = default;

  SystemClock system_;
  LogicalClock logical_;
  AdjustedClock adjusted_;
};

}  // namespace coil
