// The clock of recordings: simulated time while a simulator exists, otherwise wall-clock time. Any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

#include "base/clock.h"

namespace recorder {

class RunClock final : public base::Clock {
 public:
  explicit RunClock(std::uint32_t server_id);
  ~RunClock() override;

  // After the simulator's end: its last time.
  std::chrono::nanoseconds now() const override;
  bool is_simulated() const;
  // Time waits for whoever takes part, so that a recorder may take its time, too.
  bool is_lockstep() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// $RTMSIM_SERVER_ID, else 0.
std::uint32_t default_server_id();

}  // namespace recorder
