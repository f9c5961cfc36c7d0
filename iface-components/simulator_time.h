// What time it is in a simulator now, for threads that no tick runs: those that receive data. Any thread.
#pragma once

#include <base/clock.h>
#include <shm/client.h>

#include <mutex>
#include <optional>

namespace iface {

class SimulatorTime final : public base::Clock {
 public:
  // The time stays where it was when the simulator goes; 0 before the first one.
  void follow(std::optional<shm::Iface> simulation);
  std::chrono::nanoseconds now() const override;
  // Counts the resets, and the simulators after the first.
  std::uint64_t era() const override;
  // Time does not pass: paused, waiting for participants, or there is no simulator.
  bool stands_still() const;

 private:
  const shm::SimulationSample* read() const;

  mutable std::mutex mutex_;
  mutable std::optional<shm::Iface> simulation_;
  mutable std::chrono::nanoseconds last_{0};
  mutable std::uint64_t era_ = 0;
  mutable std::uint32_t resets_ = 0;  // as seen last
  std::uint64_t generation_ = 0;      // of the simulator seen last; 0: none
};

}  // namespace iface
