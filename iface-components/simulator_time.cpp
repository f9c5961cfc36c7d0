#include "simulator_time.h"

#include <shm/lockstep.h>

#include <utility>

namespace iface {

void SimulatorTime::follow(std::optional<shm::Iface> simulation) {
  auto state = state_.lock();
  state->simulation.swap(simulation);  // the one before ends without the lock
  if (!state->simulation) return;
  const auto generation = state->simulation->segment().facts().generation;
  const auto* sample = state->read();
  const auto resets = sample ? sample->stamp.resets : 0;
  // The same simulator once more has no new time, unless it was reset meanwhile.
  if (state->generation != 0 && (generation != state->generation || resets != state->resets)) ++state->epoch;
  state->generation = generation;
  state->resets = resets;
}

std::uint64_t SimulatorTime::epoch() const {
  auto state = state_.lock();
  const auto* sample = state->read();
  if (sample && std::exchange(state->resets, sample->stamp.resets) != sample->stamp.resets) ++state->epoch;
  return state->epoch;
}

std::uint64_t SimulatorTime::phase_counter() const {
  auto state = state_.lock();
  return state->simulation ? shm::phase_counter_of(*state->simulation) : 0;
}

const shm::SimulationSample* SimulatorTime::State::read() {
  return simulation && simulation->read() ? &simulation->sample<shm::SimulationSample>() : nullptr;
}

std::chrono::nanoseconds SimulatorTime::now() const {
  auto state = state_.lock();
  if (const auto* sample = state->read()) state->last = std::chrono::nanoseconds(sample->stamp.sim_time_ns);
  return state->last;
}

bool SimulatorTime::stands_still() const {
  auto state = state_.lock();
  const auto* sample = state->read();
  return !sample || sample->paused != 0 || sample->waiting_for != 0;
}

}  // namespace iface
