// Evaluates a condition in every tick, and pauses the simulation when it becomes true. It has a thread of its own, which is the last
// participant of the lock step; construct and use it on one thread.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recording/expression.h"
#include "run/run_system.h"
#include "system/session.h"

namespace recorder {

class BreakWatch {
 public:
  // Fails when a port or model that the condition needs is not there.
  static base::Result<std::unique_ptr<BreakWatch>> start(CORBA::ORB_ptr orb, const tools::RunningSystem& system,
                                                         const Expression& condition);
  ~BreakWatch();

  // The time of the tick in which the condition held; the simulation is paused then.
  std::optional<std::chrono::nanoseconds> hit() const;
  // What the condition needs and is not there at this moment, as "A0:out has no member data.x"; while time stands still.
  std::vector<std::string> missing() const;

  struct State;
  explicit BreakWatch(std::unique_ptr<State> state);

 private:
  std::unique_ptr<State> state_;
};

// The shortest period of those that take part in the simulation's lock step; a step when nobody does.
base::Result<std::chrono::nanoseconds> tick_of(const std::string& simulator, double step_s);

}  // namespace recorder
