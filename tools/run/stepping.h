// Lets a simulator make steps, and watches that they go on. One thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "base/result.h"
#include "run/simulator.h"

namespace tools {

struct Stepping {
  bool is_paced = false;       // at the real-time factor, else as fast as possible
  double hang_timeout_s = 30;  // of real time, for one tick
  // Called about ten times a second of real time; its Error ends the wait.
  std::function<base::Result<void>()> alive = [] { return base::Result<void>(); };
  // Called with the simulated time [s] as often.
  std::function<void(double)> passed = [](double) {};
  // Called with a line that names a participant that is late for a second.
  std::function<void(const std::string&)> warn = [](const std::string&) {};
};

// Returns when the steps are done. An Error: `alive` returned one, an interrupt came, another client paused or reset the simulation, or no
// step ended within the timeout; the message names the participants that are late.
base::Result<void> make_steps(Simulator& simulator, std::int64_t steps, const Stepping& stepping);

}  // namespace tools
