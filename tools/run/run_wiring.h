// Connects and activates the components of a run: at the start, and again after a process of components was restarted. Its calls have
// timeouts. One thread at a time.
#pragma once

#include <omniORB4/CORBA.h>

#include <functional>
#include <optional>
#include <string>

#include "run/foreign_processes.h"
#include "run/run_hosts.h"
#include "run/run_naming.h"
#include "run/run_simulator.h"
#include "run/simulator.h"
#include "system/saved_system.h"
#include "system/session.h"

namespace tools {

class Reporter;

class RunWiring {
 public:
  // All must live as long.
  struct Parts {
    const CORBA::ORB_var& orb;
    const RunOptions& options;
    const RunHooks& hooks;
    Reporter& reporter;
    const Workplace& place;
    RunNaming& naming;
    Simulator& simulator;
    RunHosts& hosts;
    ForeignProcesses& foreign;
    SavedSystem& system;
  };
  // `wait_until` waits as long as a start may take; `check_children` returns an Error when a process has ended.
  RunWiring(Parts parts, RunSimulator::Wait wait_until, std::function<Result<void>()> check_children)
      : parts_(parts), wait_until_(std::move(wait_until)), check_children_(std::move(check_children)) {}

  // Wires and activates all, and writes the system as it is for this run to the workplace. Appends to `notes`.
  Result<void> wire(std::vector<std::string>& notes);
  // Connections that a dead process has left behind are made again, the others stand. Components of killed processes are left out.
  Result<void> wire_again(const RunHosts::Members& members);

  bool has_session() const { return session_.has_value(); }
  const Session& session() const { return *session_; }  // after wire()
  // Stops the naming service, or lets it go on; components are found all the same.
  void set_naming(bool is_there);
  Result<ComponentView> component(const std::string& instance, Detail detail);
  // Whether lock step waits for one of them.
  bool has_participant_of(const RunHosts::Members& members);

 private:
  Result<void> check(const std::string& goal, const Changes& changes);
  Result<void> wait_for_participants();

  Parts parts_;
  const RunSimulator::Wait wait_until_;
  const std::function<Result<void>()> check_children_;
  std::optional<Session> session_;
  std::optional<NamingTree> names_;  // while the naming service is stopped by a script
};

}  // namespace tools
