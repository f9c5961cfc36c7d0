// The gateway as a lock-step participant. The event loop sleeps here between ticks, so a tick wakes one thread. If the simulator exits, or
// drops the gateway, the gateway joins again. interrupt() belongs to any thread, the rest to one at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "base/guarded.h"
#include "shm/lockstep.h"

namespace ros2 {

class LockStepParticipant {
 public:
  // `period`: of the ticks; 0: every step.
  LockStepParticipant(std::uint32_t server_id, std::chrono::nanoseconds period) : server_id_(server_id), period_(period) {}

  // False while there is no simulator; looks for one some times a second.
  bool join();
  // After join(), between ticks. The tick that began; nothing after interrupt() or the time.
  std::optional<shm::Tick> sleep(std::chrono::nanoseconds time);
  void finish();
  // Ends a sleep(), also the next one.
  void interrupt();
  void leave();

 private:
  const std::uint32_t server_id_;
  const std::chrono::nanoseconds period_;
  std::chrono::steady_clock::time_point next_look_{};
  std::shared_ptr<shm::Participant> participant_;
  base::Guarded<std::shared_ptr<shm::Participant>, base::Rank::worker> sleeper_;  // the same, for interrupt()
};

}  // namespace ros2
