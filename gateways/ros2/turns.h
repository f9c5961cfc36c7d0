// The gateway's place in the lock step: a thread waits for ticks and hands each to the event loop, which says when it is done. After the
// simulator has ended, or dropped the gateway, it joins again. The public functions belong to one thread at a time.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <optional>
#include <thread>

#include "base/guarded.h"
#include "shm/lockstep.h"

namespace ros2 {

class Turns {
 public:
  // `on_tick` is called by the thread when a tick begins.
  Turns(std::uint32_t server_id, std::chrono::nanoseconds period, std::function<void()> on_tick);
  ~Turns();
  Turns(const Turns&) = delete;
  Turns& operator=(const Turns&) = delete;

  // The tick that runs and waits for finish(); nothing between ticks.
  std::optional<shm::Tick> tick();
  void finish();

 private:
  struct State {
    std::optional<shm::Tick> tick;
  };
  void run(const std::stop_token& stop);
  void hand_over(const shm::Tick& tick, const std::stop_token& stop);

  const std::uint32_t server_id_;
  const std::chrono::nanoseconds period_;
  const std::function<void()> on_tick_;
  base::Guarded<State, base::Rank::worker> state_;
  std::condition_variable_any changed_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace ros2
