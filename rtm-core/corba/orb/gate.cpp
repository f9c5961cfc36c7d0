#include "corba/orb/gate.h"

namespace corba {

bool Gate::enter() {
  auto state = state_.lock();
  if (state->is_closed) return false;
  ++state->inside;
  return true;
}

void Gate::leave() {
  // Notified under the lock: the one who waits destroys the gate.
  auto state = state_.lock();
  if (--state->inside == 0 && state->is_closed) empty_.notify_all();
}

void Gate::close() {
  auto state = state_.lock();
  state->is_closed = true;
  while (!state.wait_for(empty_, std::chrono::hours(1), [&] { return state->inside == 0; })) {
  }
}

}  // namespace corba
