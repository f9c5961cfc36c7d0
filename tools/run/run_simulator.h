// The simulator of a run: a sim-server of its own under an id that no other has, told what to do through simctl. One thread at a time.
//
// Verdicts on poses and contacts are read from the file that sim-server --record writes, so the system editor needs no shared memory.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/child_process.h"
#include "run/chance_report.h"
#include "run/run_files.h"
#include "run/run_hashes.h"
#include "run/run_system.h"
#include "system/reporter.h"

namespace editor {

class RunSimulator {
 public:
  // Waits until `ready`, or says of `what` why it never will be.
  using Wait = std::function<Result<void>(const std::string& what, const std::function<bool()>& ready)>;

  // All must live as long.
  RunSimulator(const RunOptions& options, const Workplace& place, const RunHashes& hashes, Reporter& reporter)
      : options_(options), place_(place), hashes_(hashes), reporter_(reporter) {}

  // Returns when it answers, paused before its first step.
  Result<void> start(const Wait& wait_until);
  // Takes it down, with what a killed one leaves in shared memory.
  void end();

  // An error that says how it ended, when it has started and ended.
  Result<void> check();
  const std::string& id() const { return id_; }
  pid_t pid() const { return process_ ? process_->pid() : 0; }
  double step() const { return step_s_; }  // [s]
  // What it said before its first step that is more than information.
  std::vector<std::string> notes() const;

  Result<std::string> simctl(const std::vector<std::string>& words, std::chrono::milliseconds limit) const;
  // An empty object when it does not answer.
  nlohmann::json statistics(std::chrono::milliseconds limit) const;
  std::optional<double> time() const;              // [s], simulated
  double last_time() const { return last_time_; }  // as it was when it was asked last
  std::set<std::string> participants() const;
  PlacesInTime places() const;
  std::vector<std::string> late() const;  // participants that have not ended their tick
  std::vector<std::string> models() const;

  // So many steps; given up when `alive` has something to say, or when time stands still for longer than a tick may take. `passed` is told
  // the simulated time [s], about once a second of real time.
  Result<void> make_steps(
      std::int64_t steps, const std::function<Result<void>()>& alive, const std::function<void(double)>& passed = [](double) {});

 private:
  Result<void> try_start(const Wait& wait_until);
  std::optional<pid_t> owner() const;
  std::string who_waits() const;
  std::string who_hangs() const;
  std::string segment_prefix() const;
  bool is_in_memory() const;
  void remove_segments() const;

  const RunOptions& options_;
  const Workplace& place_;
  const RunHashes& hashes_;
  Reporter& reporter_;
  std::optional<ChildProcess> process_;
  std::string id_;
  double step_s_ = 0;
  double last_time_ = 0;  // [s], when it was asked last
};

}  // namespace editor
