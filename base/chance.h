// Reports nondeterministic events of a run in lock step in the log: a write by a thread that no tick runs, a sample that arrived between
// ticks. Each place in this process is reported once, at level info; `rtse run --strict` makes it a failure. Any thread.
#pragma once

#include <chrono>
#include <memory>
#include <string_view>

#include "base/clock.h"

namespace base {

// The time of a lock step, for whoever it concerns. Any thread.
class LockStepClock : public Clock {
 public:
  // Time does not pass: it has been stopped, or has not begun. What is done from outside then comes at the same time in each run.
  virtual bool stands_still() const = 0;
};

// What such a message begins with.
inline constexpr std::string_view chance_mark = "nondeterministic: ";

// "port A:out" "was written by a thread that no tick runs".
void tell_of_chance(std::string_view where, std::string_view what, std::chrono::nanoseconds simulated);

// Of the lock step that this process takes part in; the one that was told last. nullptr: there is none.
void set_lock_step_clock(const std::shared_ptr<const LockStepClock>& clock);
std::shared_ptr<const LockStepClock> lock_step_clock();

}  // namespace base
