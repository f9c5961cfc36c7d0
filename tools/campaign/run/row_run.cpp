#include "campaign/run/row_run.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/interrupt.h"
#include "base/text.h"
#include "campaign/run/row_script.h"
#include "campaign/run/value_script.h"
#include "run/prefork_server.h"
#include "run/run_page.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

std::string recording_of(const RowRunOptions& options) { return options.folder + "/run.mcap"; }

// A page that cannot be written takes nothing from the verdict.
void write_page(const RowRunOptions& options, tools::RunResult& run) {
  if (options.page.empty()) return;
  std::error_code ignored;
  if (!run.is_passed() && fs::exists(recording_of(options), ignored)) {
    const auto written = tools::write_run_page({recording_of(options), options.page}, tools::page_summary(run, options.command));
    if (!written) return run.notes.push_back(written.error().message + "; the recording is kept: " + recording_of(options));
  }
  if (!options.records) fs::remove(recording_of(options), ignored);
}

tools::RunOptions options_of(const Campaign& campaign, const Row& row, const RowRunOptions& options) {
  auto run = campaign.plan().run;
  run.seed = row.seed;
  run.duration_s = options.duration_s.value_or(run.duration_s);
  run.properties = campaign.properties_of(row);
  run.lists = campaign.lists_of(row);
  run.keep = options.folder;
  if (options.records || !options.page.empty()) run.record = recording_of(options);
  return run;
}

// The files of the row: the world, when it is another one, and the expectations, when they stand in the plan.
Result<void> write_files(const Plan& plan, const std::optional<WorldFile>& world, tools::RunOptions& run) {
  std::error_code error;
  fs::create_directories(run.keep, error);
  if (error) return Error{"folder " + base::in_quotes(run.keep) + ": " + error.message()};
  if (world) {
    const auto folder = run.keep + "/world";
    if (const auto written = world->write(folder); !written) return written;
    run.world = folder + "/world.sdf";
    run.resource_paths.push_back(world->folder());
    if (fs::is_directory(world->folder() + "/models", error)) run.resource_paths.push_back(world->folder() + "/models");
  }
  if (!plan.expect_text.empty()) {
    run.expectations = run.keep + "/expect.yaml";
    std::ofstream out(run.expectations);
    out << plan.expect_text << '\n';
    if (!out.flush()) return Error{"file " + base::in_quotes(run.expectations) + ": cannot be written"};
  }
  return {};
}

Outcome run_once(CORBA::ORB_ptr orb, const Campaign& campaign, const Row& row, const RowRunOptions& options, tools::Reporter& reporter) {
  Outcome outcome;
  const auto world = campaign.world_of(row);
  if (!world) {
    outcome.run.has_begun = true;  // with these values it never will
    outcome.run.problem = world.error().message;
    return outcome;
  }
  auto run = options_of(campaign, row, options);
  if (const auto written = write_files(campaign.plan(), *world, run); !written) {
    outcome.run.problem = written.error().message;
    return outcome;
  }
  RowScript script(campaign, row,
                   {.folder = fs::absolute(options.folder).string(),
                    .actions = options.actions.value_or(
                        Actions{campaign.plan().events, campaign.plan().faults, campaign.plan().never, campaign.plan().eventually}),
                    .duration_s = run.duration_s,
                    .checks_invariants = options.checks_invariants || campaign.plan().checks_invariants,
                    .draws = options.draws && campaign.plan().has_pictures});
  for (const auto& property : script.properties()) run.properties.push_back(property);
  const tools::RunHooks hooks{.simulator_options = script.simulator_options(), .prefork = options.prefork, .script = &script};
  outcome.run = tools::run_system(orb, run, reporter, hooks);
  write_page(options, outcome.run);
  outcome.measures = script.measures();
  outcome.features = script.features();
  for (const auto& measure : campaign.plan().measures) {
    if (measure.kind == Measure::Kind::wall_time && outcome.run.problem.empty()) outcome.measures[measure.name] = outcome.run.wall_s;
  }
  std::error_code ignored;  // files that stay do no harm
  if (outcome.run.is_passed() && !options.keeps_files) fs::remove_all(options.folder, ignored);
  return outcome;
}

}  // namespace

Result<void> check_values(CORBA::ORB_ptr orb, const Campaign& campaign, const std::string& folder, tools::Reporter& reporter) {
  ValueScript script(campaign.plan());
  if (!script.is_needed()) return {};
  auto run = options_of(campaign, Row{}, {.folder = folder});
  run.expectations.clear();
  static_cast<void>(tools::run_system(orb, run, reporter, {.script = &script}));
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  if (script.problem().empty()) return {};
  return Error{"plan " + base::in_quotes(campaign.plan().file) + ": " + script.problem()};
}

Outcome run_row(CORBA::ORB_ptr orb, const Campaign& campaign, const Row& row, const RowRunOptions& options, tools::Reporter& reporter) {
  const auto prefork = options.prefork != nullptr ? options.prefork->count() : 0;
  auto outcome = run_once(orb, campaign, row, options, reporter);
  if (outcome.run.problem.empty() || prefork == 0 || options.prefork->count() == prefork || base::is_interrupted()) return outcome;
  // Who made a program of it was killed and took that along: that says nothing about the row.
  std::error_code ignored;
  fs::remove_all(options.folder, ignored);
  auto alone = options;
  alone.prefork = nullptr;
  return run_once(orb, campaign, row, alone, reporter);
}

}  // namespace campaign
