#include "base/nondeterminism.h"

#include <set>
#include <string>

#include "base/guarded.h"
#include "base/log.h"
#include "base/text.h"

namespace base {
namespace {

Guarded<std::weak_ptr<const LockStepClock>, Rank::noted>& clock_of_lock_step() {
  // Never destroyed: calls may come at the very end.
  static auto& clock = *new Guarded<std::weak_ptr<const LockStepClock>, Rank::noted>;
  return clock;
}

}  // namespace

void set_lock_step_clock(const std::shared_ptr<const LockStepClock>& clock) { *clock_of_lock_step().lock() = clock; }
std::shared_ptr<const LockStepClock> lock_step_clock() { return clock_of_lock_step().snapshot().lock(); }

void report_nondeterminism(std::string_view where, std::string_view what, std::chrono::nanoseconds simulated) {
  static auto& told = *new Guarded<std::set<std::string>, Rank::noted>;  // never destroyed, likewise
  const std::string text = std::string(where) + " " + std::string(what);
  if (!told.lock()->insert(text).second) return;
  log(Level::info, "lock step", "{}{} at {} s", nondeterminism_mark, text, format_number(to_seconds(simulated)));
}

}  // namespace base
