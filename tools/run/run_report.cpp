// What a run has shown, as JSON and as JUnit XML.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "run/junit.h"
#include "run/run_system.h"

namespace tools {

std::string RunResult::first_problem() const {
  if (!problem.empty()) return problem;
  const auto unmet = std::ranges::find_if(verdicts, [](const Verdict& verdict) { return !verdict.problem.empty(); });
  return unmet == verdicts.end() ? "" : failure_text(*unmet);
}

nlohmann::ordered_json to_json(const RunResult& result) {
  nlohmann::ordered_json json{{"seed", result.seed},
                              {"passed", result.is_passed()},
                              {"problem", result.problem},
                              {"logs", result.logs},
                              {"notes", result.notes},
                              {"state_hash", result.state_hash},
                              {"run_hash", result.run_hash},
                              {"path", result.path_m},
                              {"simulated", result.simulated_s},
                              {"wall", result.wall_s},
                              {"page", result.page},
                              {"runs", result.runs},
                              {"refused", static_cast<int>(result.refusal)},
                              {"expectations", nlohmann::ordered_json::array()}};
  for (const auto& verdict : result.verdicts) {
    nlohmann::ordered_json entry{
        {"expectation", verdict.expectation}, {"problem", verdict.problem}, {"details", verdict.details}, {"failure", verdict.failure}};
    if (verdict.time) entry["time"] = *verdict.time;
    if (!verdict.subject.empty()) entry["subject"] = verdict.subject;
    json["expectations"].push_back(std::move(entry));
  }
  return json;
}

RunResult run_result_of(const nlohmann::ordered_json& json) {
  RunResult result;
  result.seed = json.value("seed", std::uint64_t{0});
  result.problem = json.value("problem", "");
  result.logs = json.value("logs", "");
  result.notes = json.value("notes", std::vector<std::string>());
  result.state_hash = json.value("state_hash", "");
  result.run_hash = json.value("run_hash", "");
  result.page = json.value("page", "");
  result.path_m = json.value("path", 0.0);
  result.runs = json.value("runs", 1);
  const int refusal = json.value("refused", 0);
  result.refusal = refusal >= 0 && refusal <= 2 ? static_cast<RunResult::Refusal>(refusal) : RunResult::Refusal::none;
  result.simulated_s = json.value("simulated", 0.0);
  result.wall_s = json.value("wall", 0.0);
  for (const auto& entry : json.value("expectations", nlohmann::ordered_json::array())) {
    result.verdicts.push_back({entry.value("expectation", ""), entry.value("problem", ""), entry.value("details", ""),
                               entry.value("failure", ""), std::nullopt, entry.value("subject", "")});
    if (entry.contains("time")) result.verdicts.back().time = entry.value("time", 0.0);
  }
  return result;
}

Result<void> write_junit(const std::string& file, const RunOptions& options, const std::vector<RunResult>& results) {
  using Outcome = JunitCase::Outcome;
  std::vector<JunitCase> cases;
  for (const auto& result : results) {
    std::error_code ignored;
    const auto page = !result.page.empty() && std::filesystem::exists(result.page, ignored) ? result.page : "";
    const auto group = std::filesystem::path(options.world).stem().string() + ".seed_" + std::to_string(result.seed);
    cases.push_back({.outcome = result.problem.empty() ? Outcome::passed : Outcome::broken,
                     .group = group,
                     .name = "runs for " + base::format_number(options.duration_s) + " s",
                     .wall_s = result.wall_s,
                     .problem = result.problem,
                     .output = result.state_hash.empty() ? "" : "state " + result.state_hash,
                     .errors = result.problem.empty() ? "" : result.logs,
                     .attachment = page});
    for (const auto& verdict : result.verdicts)
      cases.push_back({.outcome = verdict.problem.empty() ? Outcome::passed : Outcome::failed,
                       .group = group,
                       .name = verdict.expectation,
                       .problem = verdict.problem,
                       .details = verdict.details,
                       .attachment = verdict.problem.empty() ? "" : page});
  }
  return write_junit_suite(file, std::filesystem::path(options.system).stem().string(), cases);
}

}  // namespace tools
