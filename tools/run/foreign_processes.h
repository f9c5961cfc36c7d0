// Third-party processes of a run: those that `rtse run --start` and a run file name. They are started with the run's name server in their
// environment, their components take part in simulated time through proxies (time_members.h), and they are ended by process group. One
// thread at a time.
//
// The environment of a process:
//   RTCTREE_NAMESERVERS, RTMSIM_NAMING   the name server, "127.0.0.1:43210"
//   ORBInitRef                           the same for omniORB: "NameService=corbaname::127.0.0.1:43210"
//   RTC_MANAGER_CONFIG                   an rtc.conf of the run: corba.nameservers, and logs to standard output
//   RTMSIM_SERVER_ID                     the simulator
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/child_process.h"
#include "run/run_file.h"
#include "run/run_files.h"
#include "run/run_system.h"
#include "system/profile/rts_profile.h"

namespace tools {

class ForeignProcesses {
 public:
  explicit ForeignProcesses(const Workplace& place) : place_(place) {}

  // Which components of the system come from where: those that the run file names, and with --start all others of whose type there is no
  // module. Each must be in the system, with a rate; `properties` may choose its phase, and get the turns of our own (call_order.h).
  Result<void> read(const RunOptions& options, const SavedSystem& system, std::vector<ComponentProperty>& properties);
  bool empty() const { return processes_.empty(); }
  bool has(const std::string& instance) const;
  // In the order of the system.
  const std::vector<TimeMember>& members() const { return members_; }
  std::vector<std::string> names() const;
  // The longest that somebody waits for the components of a process.
  std::chrono::duration<double> start_timeout(std::chrono::duration<double> usual) const;

  Result<void> start(const std::string& naming, const std::string& server_id);
  // What the host of their contexts is made of: a proxy for each that needs one, and OpenHRP's clock.
  std::vector<std::string> creations(const std::string& server_id) const;
  std::vector<std::string> proxies() const;
  // Brings them into simulated time, once they and their proxies are there; each may take so long for it. In `system` their states are then
  // those in these contexts.
  Result<void> join(const Session& session, SavedSystem& system, std::chrono::milliseconds timeout);
  // Deactivates those that are active, in the order in which the system stops. What could not be deactivated, one line each.
  std::vector<std::string> rest(const Session& session, const SavedSystem& system) const;
  struct Ended {
    std::vector<std::string> components;  // those of all open ones, if it is open: nobody has said whose components they are
    bool is_open = false;
    bool is_only_one = false;        // that is open
    std::string command, how, said;  // "sh start.sh", "was killed by signal 9", its last telling line
  };
  // The first process that has.
  std::optional<Ended> ended();
  // Where a component comes from, and what its process says, for messages.
  std::string about(const std::string& instance) const;
  // The last line of the last traceback that its process has written, "ValueError: no scan"; empty: there is none.
  std::string traceback_of(const std::string& instance) const;
  std::string last_words() const;
  std::vector<RunningSystem::Process> processes() const;  // the shells that run the commands
  void terminate();
  // With SIGKILL, all that the commands have started. Any thread.
  void kill() const;
  void end() { running_.clear(); }

  // Links into our ports get stamps of simulated time, unless the system says otherwise, and links from components of others send at once
  // (flush), as a thread of theirs belongs to no tick. What there is to say of that.
  std::vector<std::string> set_links(SavedSystem& system) const;
  // Those to whom late components of others send, who may hang in taking it: "; Alien.out sends to Other.in". Empty: nobody.
  std::string who_may_be_waited_for(const SavedSystem& system, const std::vector<std::string>& late) const;
  // What depends on chance because it cannot be ordered; known after join().
  const std::vector<std::string>& nondeterministic_events() const { return nondeterministic_events_; }

 private:
  struct Running {
    base::ChildProcess process;
    std::string components;
    std::string log;
  };
  std::vector<std::string> components_of(const ForeignProcess& process) const;
  void order_calls(const SavedSystem& system, std::vector<ComponentProperty>& properties);

  const Workplace& place_;
  std::vector<ForeignProcess> processes_;
  std::vector<std::string> open_;  // those of --start, of whom nobody knows from which process
  std::vector<TimeMember> members_;
  std::vector<std::string> in_a_circle_, nondeterministic_events_;
  std::vector<Running> running_;
};

}  // namespace tools
