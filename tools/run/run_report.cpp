// What a run has shown, and the same as JUnit XML.
#include <algorithm>
#include <filesystem>

#include "base/text.h"
#include "run/junit.h"
#include "run/run_system.h"

namespace editor {

bool RunResult::is_passed() const {
  return problem.empty() && std::all_of(verdicts.begin(), verdicts.end(), [](const Verdict& verdict) { return verdict.problem.empty(); });
}

Result<void> write_junit(const std::string& file, const RunOptions& options, const std::vector<RunResult>& results) {
  using Outcome = JunitCase::Outcome;
  std::vector<JunitCase> cases;
  for (const auto& result : results) {
    const auto group = std::filesystem::path(options.world).stem().string() + ".seed_" + std::to_string(result.seed);
    cases.push_back({.outcome = result.problem.empty() ? Outcome::passed : Outcome::broken,
                     .group = group,
                     .name = "runs for " + base::format_number(options.duration_s) + " s",
                     .wall_s = result.wall_s,
                     .problem = result.problem,
                     .output = result.state_hash.empty() ? "" : "state " + result.state_hash,
                     .errors = result.problem.empty() ? "" : result.logs});
    for (const auto& verdict : result.verdicts)
      cases.push_back({.outcome = verdict.problem.empty() ? Outcome::passed : Outcome::failed,
                       .group = group,
                       .name = verdict.expectation,
                       .problem = verdict.problem,
                       .details = verdict.details});
  }
  return write_junit_suite(file, std::filesystem::path(options.system).stem().string(), cases);
}

}  // namespace editor
