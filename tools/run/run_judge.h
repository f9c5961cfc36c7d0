// The verdict on a run, from its expectations and the measured values. Call in this order: `read` before anything starts, `look` at the
// end, while the simulation is paused and all processes run, then `run_commands`, and `judge` last. One thread.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "run/expectations.h"
#include "run/foreign_processes.h"
#include "run/run_files.h"
#include "run/run_hosts.h"
#include "run/run_system.h"
#include "run/simulator.h"
#include "system/profile/rts_profile.h"
#include "system/session.h"

namespace tools {

class RunJudge {
 public:
  // All of these outlive it.
  RunJudge(const RunOptions& options, const RunHooks& hooks, const Workplace& place, const SavedSystem& system, Simulator& simulator,
           const RunHosts& hosts, const ForeignProcesses& foreign)
      : options_(options), hooks_(hooks), place_(place), system_(system), simulator_(simulator), hosts_(hosts), foreign_(foreign) {}

  // The file of expectations, if there is one. An Error also where it names a component that the system does not have.
  Result<void> read();
  // Before the first step: that the models, ports and members exist. `may_spawn`: the system may add models to the world, so that a model
  // that is not there yet is no error.
  Result<void> check_models(bool may_spawn) const;
  Result<void> check_values(const Session& session) const;
  const std::vector<Expectation>& expectations() const { return expectations_; }
  // Takes over what happened to the models since the last call: before the first step, and from time to time.
  Result<void> watch();
  // What was seen on ports, by "port member".
  void take_values(std::map<std::string, SeenValue> values) { seen_.values = std::move(values); }
  // What can be seen only while everything still runs: states, poses, the picture, the hash. Fails when the simulator does not answer.
  // `nondeterministic_events`: what is known already to depend on chance.
  Result<void> look(const Session& session, const std::vector<std::string>& nondeterministic_events, RunResult& result);
  // The user's commands. Fails after an interrupt, and when a command cannot be started; its exit code is for the verdict.
  Result<void> run_commands(const std::string& naming);
  // The record against the expectations. Fails when the record does not reach to the end of the run.
  Result<void> judge(RunResult& result);
  const Seen& seen() const { return seen_; }

 private:
  // All that is to be seen: what is expected, and what a script watches.
  std::vector<const Expectation*> looked_at() const;
  void want_joints();
  Result<void> look_at_grips();
  void check_determinism(const std::vector<std::string>& known, RunResult& result) const;
  void check_states(RunResult& result) const;
  Error in_file(const Error& error) const;  // of expectations
  std::string why_error(const std::string& component) const;

  const RunOptions& options_;
  const RunHooks& hooks_;
  const Workplace& place_;
  const SavedSystem& system_;
  Simulator& simulator_;
  const RunHosts& hosts_;
  const ForeignProcesses& foreign_;
  std::vector<Expectation> expectations_;
  PoseRecord record_;  // part of what was seen when the run has come to its end
  Seen seen_;
  std::set<std::string> providers_;  // full names of ports
};

}  // namespace tools
