// The process of a run's simulator: a sim-server of its own under a server ID that no other has. `control()` controls it. One thread at a
// time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/child_process.h"
#include "run/run_files.h"
#include "run/run_hashes.h"
#include "run/run_system.h"
#include "run/shm_simulator.h"

namespace tools {

class RunSimulator {
 public:
  // Waits until `ready`, or says of `what` why it never will be.
  using Wait = std::function<Result<void>(const std::string& what, const std::function<bool()>& ready)>;

  // All must live as long.
  RunSimulator(const RunOptions& options, const RunHooks& hooks, const Workplace& place, const RunHashes& hashes)
      : options_(options), hooks_(hooks), place_(place), hashes_(hashes) {}

  // Returns when it answers, paused before its first step.
  // `writes_poses`: with a pose log for the user's commands, record.txt.
  Result<void> start(const Wait& wait_until, bool writes_poses);
  // Takes it down, with what a killed one leaves in shared memory. An Error: it could not write its files, on a full disk for instance.
  Result<void> end();

  // An error that says how it ended, when it has started and ended.
  Result<void> check();
  // The reason if the simulator rejected its command line, or a file on it; empty: it did not.
  std::string refusal();
  pid_t pid() const { return process_ ? process_->pid() : 0; }
  // Valid as long as this object; before start() its requests fail.
  Simulator& control() { return control_; }
  // What it said before its first step that is more than information.
  std::vector<std::string> notes() const;

 private:
  Result<void> try_start(std::uint32_t id, const Wait& wait_until, bool writes_poses);
  std::optional<pid_t> owner(std::uint32_t id) const;

  const RunOptions& options_;
  const RunHooks& hooks_;
  const Workplace& place_;
  const RunHashes& hashes_;
  std::optional<base::ChildProcess> process_;
  std::uint32_t id_ = 0;
  ShmSimulator control_;
};

}  // namespace tools
