#include "base/clock.h"

#include <utility>

namespace base {
namespace {

const Clock*& scoped_clock() {
  thread_local const Clock* clock = nullptr;
  return clock;
}

}  // namespace

std::chrono::nanoseconds SystemClock::now() const {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch());
}

const Clock& current_clock() {
  static const SystemClock system_clock;
  const Clock* clock = scoped_clock();
  return clock ? *clock : system_clock;
}

const Clock& current_clock_or(const Clock& otherwise) {
  const Clock* clock = scoped_clock();
  return clock ? *clock : otherwise;
}

std::chrono::nanoseconds FollowingClock::now() const {
  const auto clock = clock_.snapshot();
  return (clock ? *clock : current_clock()).now();
}

std::uint64_t FollowingClock::epoch() const {
  const auto clock = clock_.snapshot();
  return clock ? clock->epoch() : 0;
}

std::uint64_t FollowingClock::phase_counter() const {
  const auto clock = clock_.snapshot();
  return clock ? clock->phase_counter() : 0;
}

bool FollowingClock::is_simulated() const {
  const auto clock = clock_.snapshot();
  return (clock ? *clock : current_clock()).is_simulated();
}

void FollowingClock::follow(std::shared_ptr<const Clock> clock) {
  clock_.lock()->swap(clock);  // the one before ends without the lock
}

ScopedClock::ScopedClock(const Clock& clock) : previous_(scoped_clock()) { scoped_clock() = &clock; }
ScopedClock::~ScopedClock() { scoped_clock() = previous_; }

}  // namespace base
