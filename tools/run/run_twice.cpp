#include "run/run_twice.h"

#include <filesystem>

#include "base/hash_log.h"
#include "run/hash_report.h"
#include "run/run_files.h"

namespace tools {
namespace {

constexpr const char* verdict_name = "the run is repeatable";

Verdict compare(const std::string& first, const std::string& second) {
  const auto comparison = base::compare_hash_logs(first, second);
  Verdict verdict{.expectation = verdict_name, .problem = comparison ? difference_text(*comparison) : comparison.error().message};
  if (!verdict.problem.empty()) verdict.failure = "not repeatable: " + verdict.problem;
  return verdict;
}

std::string below(const std::string& folder, const char* name) {
  return folder.empty() ? "" : (std::filesystem::path(folder) / name).string();
}

}  // namespace

RunResult run_twice(CORBA::ORB_ptr orb, const RunOptions& options, Reporter& reporter) {
  const Workplace place("");
  RunOptions first = options, second = options;
  if (first.hash_log.empty()) first.hash_log = place.scratch("first.hashlog");
  second.hash_log = options.hash_log.empty() ? place.scratch("second.hashlog") : options.hash_log + ".2";
  first.keep = below(options.keep, "first");
  second.keep = below(options.keep, "second");
  second.picture.clear();
  // A sensor makes its samples for whoever reads them, so both runs have the same readers.
  if (!second.record.empty()) second.record = place.scratch("second.mcap");
  RunResult result = run_system(orb, first, reporter);
  if (!result.problem.empty()) return result;
  const RunResult again = run_system(orb, second, reporter);
  result.wall_s += again.wall_s;
  result.runs = 2;
  result.verdicts.push_back(
      again.problem.empty() ? compare(first.hash_log, second.hash_log)
                            : Verdict{.expectation = verdict_name, .problem = again.problem, .failure = "second run: " + again.problem});
  return result;
}

}  // namespace tools
