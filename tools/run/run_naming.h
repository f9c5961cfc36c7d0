// The name server of a run: an omniNames of its own on a free port of the loopback. Code that waits for it calls answered(), so that a
// hanging name server is reported itself, and soon, instead of an object that cannot be found without it. One thread at a time.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <optional>
#include <string>

#include "base/child_process.h"
#include "run/run_files.h"
#include "run/run_simulator.h"

namespace tools {

class RunNaming {
 public:
  // The place must live as long. One that is stopped fails the run after `hang_timeout_s`, also while nobody asks it.
  RunNaming(const Workplace& place, double hang_timeout_s) : place_(place), hang_timeout_(hang_timeout_s) {}

  // Returns when it answers.
  Result<void> start(CORBA::ORB_ptr orb, const RunSimulator::Wait& wait_until);
  // Takes it down, one that does not answer by force.
  void end();

  // HOST:PORT.
  const std::string& address() const { return address_; }
  pid_t pid() const { return process_ ? process_->pid() : 0; }

  // Stops it, or lets it go on.
  void set_running(bool is_to_run);

  // What the caller has just seen of it.
  void answered(bool has_answered);
  // An error that says how it ended, that it has not answered for some seconds, or that it is stopped.
  Result<void> check();
  // Asks it now: an error when it is there and does not answer.
  Result<void> ask();

 private:
  Error silence() const;
  bool has_been_stopped();

  const Workplace& place_;
  const std::chrono::duration<double> hang_timeout_;
  CORBA::ORB_var orb_;
  std::string address_;
  std::optional<base::ChildProcess> process_;
  bool is_stopped_ = false;  // by set_running
  bool is_silent_ = false;   // when it was asked
  std::optional<std::chrono::steady_clock::time_point> silent_since_, stopped_since_;
};

}  // namespace tools
