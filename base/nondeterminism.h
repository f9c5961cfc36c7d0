// Reports nondeterministic events of a run in lock step in the log: a write by a thread that no tick runs, a sample that arrived between
// ticks. Each place in this process is reported once, at level info; `rtse run --strict` makes it a failure. Any thread.
#pragma once

#include <chrono>
#include <memory>
#include <string_view>

#include "base/clock.h"

namespace base {

// Simulated time in lock step. Any thread.
class LockStepClock : public Clock {
 public:
  // Time does not pass: it is paused or has not started. Actions from outside then have the same time in each run.
  virtual bool stands_still() const = 0;
};

// The start of each message.
inline constexpr std::string_view nondeterminism_mark = "nondeterministic: ";

// "port A:out" "was written by a thread that no tick runs".
void report_nondeterminism(std::string_view where, std::string_view what, std::chrono::nanoseconds simulated);

// The clock of the lock step that this process takes part in; the latest one that was set. nullptr: none.
void set_lock_step_clock(const std::shared_ptr<const LockStepClock>& clock);
std::shared_ptr<const LockStepClock> lock_step_clock();

}  // namespace base
