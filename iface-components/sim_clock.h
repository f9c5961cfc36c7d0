// The simulated time that a context received last. Set by the context's thread, read by any.
#pragma once

#include <base/clock.h>

#include <atomic>
#include <chrono>
#include <cstdint>

namespace iface {

class SimClock final : public base::Clock {
 public:
  std::chrono::nanoseconds now() const override { return std::chrono::nanoseconds(now_.load(std::memory_order_acquire)); }
  void set(std::chrono::nanoseconds now) { now_.store(now.count(), std::memory_order_release); }  // pairs with the acquire in now
  bool is_simulated() const override { return true; }

 private:
  std::atomic<std::int64_t> now_{0};
};

// True while the running context is one of simulated time, of this process or of another: nothing may wait for time to pass then, because
// time waits for us.
inline bool in_simulated_time() { return base::current_clock().is_simulated(); }

}  // namespace iface
