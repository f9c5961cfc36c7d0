// Finds third-party components that were lost in a run, and describes each: its name, the time, and how its process ended. One thread at a
// time.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "run/foreign_processes.h"
#include "run/run_hosts.h"
#include "run/simulator.h"

namespace tools {

class LostMembers {
 public:
  // All must live as long. `answers`: whether the component of that name does, once it can be asked.
  LostMembers(ForeignProcesses& foreign, RunHosts& hosts, Simulator& simulator, std::function<bool()> can_ask,
              std::function<bool(const std::string&)> answers)
      : foreign_(foreign), hosts_(hosts), simulator_(simulator), can_ask_(std::move(can_ask)), answers_(std::move(answers)) {}

  Result<void> check();
  // A problem that somebody's end may be the reason of, which is seen a moment later: who has died answers nothing.
  Error with_reason(const Error& problem);

 private:
  Error tell(std::optional<ForeignProcesses::Ended> ended, std::vector<RunHosts::Gone> gone);

  ForeignProcesses& foreign_;
  RunHosts& hosts_;
  Simulator& simulator_;
  const std::function<bool()> can_ask_;
  const std::function<bool(const std::string&)> answers_;
  std::optional<Error> told_;  // is told again: what the contexts have said is read once
};

}  // namespace tools
