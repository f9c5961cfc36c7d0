#include "simulator_time.h"

#include <utility>

namespace iface {

void SimulatorTime::follow(std::optional<shm::Iface> simulation) {
  const std::scoped_lock lock(mutex_);
  std::swap(simulation_, simulation);
  if (!simulation_) return;
  const auto generation = simulation_->segment().facts().generation;
  const auto* sample = read();
  const auto resets = sample ? sample->stamp.resets : 0;
  // The same simulator once more has no new time, unless it was reset meanwhile.
  if (generation_ != 0 && (generation != generation_ || resets != resets_)) ++era_;
  generation_ = generation;
  resets_ = resets;
}

std::uint64_t SimulatorTime::era() const {
  const std::scoped_lock lock(mutex_);
  const auto* sample = read();
  if (sample && std::exchange(resets_, sample->stamp.resets) != sample->stamp.resets) ++era_;
  return era_;
}

const shm::SimulationSample* SimulatorTime::read() const {
  return simulation_ && simulation_->read() ? &simulation_->sample<shm::SimulationSample>() : nullptr;
}

std::chrono::nanoseconds SimulatorTime::now() const {
  const std::scoped_lock lock(mutex_);
  if (const auto* sample = read()) last_ = std::chrono::nanoseconds(sample->stamp.sim_time_ns);
  return last_;
}

bool SimulatorTime::stands_still() const {
  const std::scoped_lock lock(mutex_);
  const auto* sample = read();
  return !sample || sample->paused != 0 || sample->waiting_for != 0;
}

}  // namespace iface
