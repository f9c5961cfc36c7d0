// Hooks of a run: values before the start, actions between two steps, numbers at the end. One thread at a time; the calls are made in the
// order in which they are declared here.
//
// Actions happen while the simulation is paused and every participant has ended its tick, so runs with the same actions at the same steps
// are bit-identical.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "run/port_values.h"
#include "run/run_files.h"
#include "run/run_system.h"
#include "run/simulator.h"

namespace tools {

// What a script may use of the run while it stands between two steps.
struct RunScene {
  Simulator& simulator;
  const Workplace& place;
  const std::string& naming;  // HOST:PORT of its service
  const SavedSystem& system;
  const PortValues& values;
  std::function<Result<void>(const std::string& instance)> kill_host;     // the host of a component, with SIGKILL
  std::function<Result<void>(const std::string& instance)> restart_host;  // one that was killed; its components are wired and started
  std::function<bool(const std::string& instance)> is_away;               // its host was killed and is not there again
  std::function<void(bool is_there)> set_naming;                          // stops the naming service, or lets it go on
  // As the editor sees it; also while the naming service is stopped.
  std::function<Result<ComponentView>(const std::string& instance, Detail)> component;
  std::chrono::milliseconds transition_timeout{0};  // of a component's state, see Session
};

class RunScript {
 public:
  virtual ~RunScript() = default;
  // The system as it is read, before anything is started.
  virtual Result<void> alter(SavedSystem&) { return {}; }
  // Values of ports to be seen; their limits do not matter. They must live until the end of the run.
  virtual const std::vector<Expectation>& watched() const = 0;
  // Everything is wired and active; no step has been made.
  virtual Result<void> begin(RunScene&) { return {}; }
  // The number of steps after which it wants to do something next, more than `done`; nothing: never again.
  virtual std::optional<std::int64_t> next_stop(std::int64_t done) const = 0;
  virtual Result<void> act(RunScene&, std::int64_t done) = 0;
  // Whether it was asked for that this component is in its error state, or gone, at the end.
  virtual bool excuses(const std::string& instance) const = 0;
  // What it does between the steps, as text from which a program can do the same again in this run; empty: nothing that can be.
  virtual std::string written() const { return {}; }
  // The last call. `seen` is what the verdicts are about. The files of the run are still there, and the simulator if there is a scene.
  virtual void end(RunScene* scene, const Seen& seen, RunResult& result) = 0;
};

}  // namespace tools
