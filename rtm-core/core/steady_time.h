// The clock for deadlines of threads, as an argument: that of the machine, or one that a test controls. Any thread.
//
// A sleeper sleeps until look_again(deadline) on the machine's clock, and its condition asks now() too. Where the time can jump, on_jump
// wakes it: the function must take the lock of what the sleeper waits for once before it notifies, or the jump could fall between its look
// and its sleep.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>

#include "base/guarded.h"

namespace rt {

class SteadyTime {
 public:
  using Point = std::chrono::steady_clock::time_point;

  virtual ~SteadyTime() = default;
  virtual Point now() const = 0;
  // When, on the machine's clock, a sleeper for `deadline` must look again at the latest.
  virtual Point look_again(Point deadline) const = 0;
  // `wake` is called after each jump as long as the result lives, and not while it ends. Null where time never jumps.
  virtual std::shared_ptr<void> on_jump(std::function<void()> wake) const = 0;
};

// That of the machine.
const SteadyTime& machine_time();

// Stands still until it is moved. For tests.
class ManualTime final : public SteadyTime {
 public:
  Point now() const override { return now_.snapshot(); }
  Point look_again(Point deadline) const override;
  std::shared_ptr<void> on_jump(std::function<void()> wake) const override;
  // Sleepers whose deadline has come are awake soon after it returns.
  void advance(std::chrono::nanoseconds by);

 private:
  struct Sleepers;
  base::Guarded<Point, base::Rank::log> now_{Point(std::chrono::hours(1))};  // asked for under the locks of sleepers
  const std::shared_ptr<Sleepers> sleepers_ = make_sleepers();
  static std::shared_ptr<Sleepers> make_sleepers();
};

}  // namespace rt
