// The naming service of a run, on a port of the loopback that nobody else listens on. One thread at a time.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "run/child_process.h"
#include "run/run_files.h"
#include "run/run_simulator.h"

namespace editor {

class RunNaming {
 public:
  explicit RunNaming(const Workplace& place) : place_(place) {}  // it must live as long

  // Returns when it answers.
  Result<void> start(CORBA::ORB_ptr orb, const RunSimulator::Wait& wait_until);
  // An error that says how it ended, when it has started and ended.
  Result<void> check();
  void end() { process_.reset(); }
  // Stops it, or lets it go on.
  void set_running(bool is_to_run) const;

  const std::string& address() const { return address_; }  // HOST:PORT
  pid_t pid() const { return process_ ? process_->pid() : 0; }

 private:
  const Workplace& place_;
  std::string address_;
  std::optional<ChildProcess> process_;
};

}  // namespace editor
