// Runs one row: a system of its own, as rtse run starts it. Any thread; each run belongs to one.
#pragma once

#include <omniORB4/CORBA.h>

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "campaign/run/action_runner.h"
#include "campaign/run/campaign.h"
#include "run/run_system.h"

namespace campaign {

struct RowRunOptions {
  std::string folder;                  // of its files: logs, record, pictures; made if need be
  bool keeps_files = false;            // when it passes, too
  std::optional<Actions> actions{};    // in place of those of the plan
  std::optional<double> duration_s{};  // in place of the plan's
  bool checks_invariants = false;      // also when the plan does not ask for it
  bool draws = true;                   // a picture of a run that fails, if the plan has pictures
  bool records = false;                // run.mcap in the folder
  std::string page{};                  // HTML to write if it fails; empty: none
  std::string command{};               // that repeats it, for its page
  const tools::PreforkServers* prefork = nullptr;
};

struct Outcome {
  tools::RunResult run;
  std::map<std::string, double> measures;
  std::set<std::string> features;  // states, places and values that it has reached, coarsely
};

// Whether the components take the values that the plan has for their parameters. Starts the system for it, when there are some; one that
// does not start is no error here: rows say so. `folder`: as of a row.
Result<void> check_values(CORBA::ORB_ptr orb, const Campaign& campaign, const std::string& folder, tools::Reporter& reporter);

Outcome run_row(CORBA::ORB_ptr orb, const Campaign& campaign, const Row& row, const RowRunOptions& options, tools::Reporter& reporter);

}  // namespace campaign
