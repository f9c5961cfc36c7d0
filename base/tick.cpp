#include "base/tick.h"

#include <utility>

namespace base {
namespace {

Tick*& scoped_tick() {
  thread_local Tick* tick = nullptr;
  return tick;
}

}  // namespace

Tick* current_tick() { return scoped_tick(); }

Tick* tick_in_lock_step() {
  Tick* tick = current_tick();
  return tick && tick->phase_counter() != 0 ? tick : nullptr;
}

ScopedTick::ScopedTick(Tick& tick) : previous_(scoped_tick()) { scoped_tick() = &tick; }
ScopedTick::~ScopedTick() { scoped_tick() = previous_; }

OutsideTicks::OutsideTicks() : previous_(std::exchange(scoped_tick(), nullptr)) {}
OutsideTicks::~OutsideTicks() { scoped_tick() = previous_; }

}  // namespace base
