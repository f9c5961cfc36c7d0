// Time as an argument: code that needs the time takes a Clock, so that tests control it. Any thread.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>

#include "base/guarded.h"

namespace base {

// Implementations must be callable from any thread.
class Clock {
 public:
  virtual ~Clock() = default;
  // Time since the clock's epoch: Unix time for SystemClock, start of the simulation for simulated clocks.
  virtual std::chrono::nanoseconds now() const = 0;
  // Counts the resets of simulated time. Data of another epoch belongs to another run.
  virtual std::uint64_t epoch() const { return 0; }
  // How many phases of ticks have begun and ended in the lock step that this clock follows: odd while a phase runs, even between; 0 where
  // nothing runs in lock step. Data that is written at an odd value can be read from the next value on (base/tick.h).
  virtual std::uint64_t phase_counter() const { return 0; }
  // Its time passes only when somebody moves it, who waits for those that run on it: they must not wait for time to pass.
  virtual bool is_simulated() const { return false; }
};

class SystemClock final : public Clock {
 public:
  std::chrono::nanoseconds now() const override;
};

// Moved by its owner.
class ManualClock final : public Clock {
 public:
  std::chrono::nanoseconds now() const override { return std::chrono::nanoseconds(now_.load(std::memory_order_acquire)); }
  void set(std::chrono::nanoseconds now) { now_.store(now.count(), std::memory_order_release); }  // pairs with the acquire in now
  void advance(std::chrono::nanoseconds by) { now_.fetch_add(by.count(), std::memory_order_acq_rel); }
  std::uint64_t epoch() const override { return epoch_.load(std::memory_order_acquire); }
  void reset() {  // a concurrent reader may see a new epoch with the old time
    set(std::chrono::nanoseconds(0));
    epoch_.fetch_add(1, std::memory_order_acq_rel);
  }
  bool is_simulated() const override { return true; }

 private:
  std::atomic<std::int64_t> now_{0};
  std::atomic<std::uint64_t> epoch_{0};
};

// The clock of what runs on this thread: the execution context's while it calls a component, else the system clock.
const Clock& current_clock();
// The execution context's while it calls a component on this thread, else `otherwise`.
const Clock& current_clock_or(const Clock& otherwise);

// Passes on the time of another clock, which can be exchanged; the current clock of the calling thread while there is none.
class FollowingClock final : public Clock {
 public:
  std::chrono::nanoseconds now() const override;
  std::uint64_t epoch() const override;
  std::uint64_t phase_counter() const override;
  bool is_simulated() const override;
  void follow(std::shared_ptr<const Clock> clock);

 private:
  Guarded<std::shared_ptr<const Clock>, Rank::log> clock_;  // asked for by whatever is logged
};

// Makes `clock` the current one of this thread for the guard's life; guards nest.
class ScopedClock {
 public:
  explicit ScopedClock(const Clock& clock);
  ~ScopedClock();
  ScopedClock(const ScopedClock&) = delete;
  ScopedClock& operator=(const ScopedClock&) = delete;

 private:
  const Clock* previous_;
};

}  // namespace base
