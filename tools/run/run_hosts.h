// The processes of a run that host our components: each an rtcd with a configuration of its own, on simulated time. One thread at a time.
#pragma once

#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/child_process.h"
#include "run/run_files.h"
#include "run/run_hashes.h"
#include "run/run_system.h"
#include "run/simulator.h"
#include "system/profile/rts_profile.h"

namespace tools {

class RunHosts {
 public:
  using Members = std::vector<const SavedComponent*>;  // of one process; they must live as long

  // All must live as long.
  RunHosts(const RunOptions& options, const RunHooks& hooks, const Workplace& place, const RunHashes& hashes, Simulator& simulator)
      : options_(options), hooks_(hooks), place_(place), hashes_(hashes), simulator_(simulator) {}

  // What all of them have: the naming service, HOST:PORT, and what the user asks of single components.
  void use(std::string naming, std::vector<ComponentProperty> properties);

  // Returns before the components are there.
  Result<void> start(const Members& members);
  // Starts the requested number of processes. Each component of Python has a process of its own, because otherwise they would share an
  // interpreter.
  Result<void> start_all(const Members& all);
  // A host of what is none of the system's components. `names`: what is in it, for messages.
  Result<void> start(const std::vector<std::string>& creations, const std::string& names);
  // With SIGKILL. What was in it.
  Result<Members> kill(const std::string& instance);
  // A new host of what was killed with this component.
  Result<Members> restart(const std::string& instance);

  // An error that names the components of one that has ended, how, and when.
  Result<void> check();
  // Third-party members that contexts reported as lost since the last call.
  struct Gone {
    std::string instance;
    std::string said;              // "Alien: component of another process was lost ..."
    std::optional<double> time{};  // [s], simulated: of the tick in which it was called
  };
  std::vector<Gone> gone_members();
  // Components of `system` for which ports of our hosts wait: "; From.out waits for Alien.in". Empty: none.
  std::string who_is_waited_for(const SavedSystem& system) const;
  // The exception that brought a third-party member into its error state: "onExecute at 0.2 s: UNKNOWN"; empty: none.
  std::string what_threw(const std::string& instance) const;
  // Connections that no longer deliver, and the reason: "From.out to Alien.in: the peer throws UNKNOWN".
  std::vector<std::string> lost_connections(const SavedSystem& system) const;
  bool has(const std::string& instance) const;
  // True if its host was killed and has not been restarted.
  bool is_killed(const std::string& instance) const;
  std::vector<RunningSystem::Process> processes() const;
  std::vector<std::string> logs() const;
  // ": " and the reason from the log of a component's host.
  std::string about(const std::string& instance) const;
  // Warnings of the components.
  std::vector<std::string> warnings() const;
  std::string last_words() const;
  void terminate();
  // Sends SIGKILL to all hosts that are our own children. Any thread.
  void kill() const;
  void end() { hosts_.clear(); }

 private:
  struct Host {
    base::ChildProcess process;
    Members members;
    std::string components;  // their names
    std::string log;
    std::uintmax_t looked_at = 0;  // octets of the log
  };
  Result<void> start(const std::vector<std::string>& creations, const Members& members, const std::string& names);
  std::string creation(const SavedComponent& component) const;
  Error end_of(const Host& host);

  const RunOptions& options_;
  const RunHooks& hooks_;
  const Workplace& place_;
  const RunHashes& hashes_;
  Simulator& simulator_;
  std::string naming_;
  std::vector<ComponentProperty> properties_;
  std::vector<Host> hosts_, killed_;
  int started_ = 0;
};

std::string names_of(const RunHosts::Members& members);
std::set<std::string> instances_of(const RunHosts::Members& members);
// The stopped processes, as the beginning of a line about the processes that wait for them: "process of Alien (pid 12) is stopped, by a
// signal or a debugger; "
std::string who_is_stopped(const std::vector<RunningSystem::Process>& processes);

}  // namespace tools
