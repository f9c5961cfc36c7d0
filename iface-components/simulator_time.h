// The current time of a simulator, for threads that no tick runs, such as those that receive data. Any thread.
#pragma once

#include <base/guarded.h>
#include <base/nondeterminism.h>
#include <shm/client.h>

#include <optional>

namespace iface {

class SimulatorTime final : public base::LockStepClock {
 public:
  // The time stays where it was when the simulator goes; 0 before the first one.
  void follow(std::optional<shm::Iface> simulation);
  std::chrono::nanoseconds now() const override;
  // Counts the resets, and the simulators after the first.
  std::uint64_t epoch() const override;
  // Of the phases of its lock step.
  std::uint64_t phase_counter() const override;
  // Time does not pass: paused, waiting for participants, or there is no simulator.
  bool stands_still() const override;

 private:
  struct State {
    std::optional<shm::Iface> simulation;
    std::chrono::nanoseconds last{0};
    std::uint64_t epoch = 0;
    std::uint32_t resets = 0;      // as seen last
    std::uint64_t generation = 0;  // of the simulator seen last; 0: none
    const shm::SimulationSample* read();
  };
  mutable base::Guarded<State, base::Rank::log> state_;  // asked for by whatever is logged
};

}  // namespace iface
