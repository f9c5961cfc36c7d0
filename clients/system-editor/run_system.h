// rtse run: a whole system of processes, started from a profile, run in lock step with a simulated world, judged, and taken down without a
// trace. One thread at a time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "editor.h"
#include "expectations.h"
#include "rts_profile.h"

namespace editor {

struct RunOptions {
  std::string system;        // RTSProfile
  std::string world;         // SDFormat
  double duration_s = 60;    // simulated
  std::string expectations;  // YAML; empty: only that everything runs
  std::uint64_t seed = 0;
  bool one_process_each = false;  // a host for every component, instead of one for all
  bool in_real_time = false;
  std::vector<std::string> module_paths;
  std::vector<std::string> resource_paths;
  std::string junit;    // file to write
  std::string picture;  // PNG to write
  std::string keep;     // folder for logs and the record; empty: a temporary one, removed at the end
  bool quiet = false;   // no progress line
};

struct RunResult {
  std::vector<Verdict> verdicts;
  std::string state_hash;
  double simulated_s = 0;
  double wall_s = 0;
  double path_m = 0;  // of the first model that moved
  bool is_passed() const;
};

// Fails when the system could not be started or run; expectations that are not met are in the result.
Result<RunResult> run_system(CORBA::ORB_ptr orb, const RunOptions& options);
// The command: prints one line per run and one per unmet expectation. `seeds`: "", or FIRST..LAST, `jobs` of them at a time.
void run(Editor& editor, const RunOptions& options, const std::string& seeds, int jobs);
Result<void> write_junit(const std::string& file, const RunOptions& options, const std::vector<RunResult>& results);

}  // namespace editor
