// sweep: all rows of a plan, or one of them.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "base/child_process.h"
#include "base/command_line.h"
#include "base/interrupt.h"
#include "base/output_name.h"
#include "base/shell_word.h"
#include "base/text.h"
#include "base/whole_file.h"
#include "campaign/plan/grammar.h"
#include "campaign/results/statistics.h"
#include "campaign/run/sweep.h"
#include "campaign/slurm/slurm_sweep.h"
#include "rtse/campaign/campaign_commands.h"
#include "rtse/command.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

using tools::Console;
using tools::Session;

constexpr const char* no_state = "-";  // of a run that does not get to its end

struct SweepCall {
  std::string plan, results, keep, audit = "0", state, rows, engine = "local", shared, task;
  std::vector<std::string> sbatch;
  std::size_t chunk = 10;
  int jobs = 1, tries = 3;
  std::size_t row = 0;
  bool records = false, pages = false, fails_fast = false, prints_schema = false;
};

std::string results_of(const SweepCall& call) {
  if (!call.results.empty()) return call.results;
  return fs::path(call.plan).replace_extension(".db").string();
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(std::lround(seconds));
  char text[32];
  std::snprintf(text, sizeof text, whole >= 3600 ? "%ld:%02ld:%02ld" : "%ld:%02ld", whole >= 3600 ? whole / 3600 : whole / 60,
                whole >= 3600 ? whole / 60 % 60 : whole % 60, whole % 60);
  return text;
}

void show_progress(const Progress& progress) {
  constexpr std::size_t width = 30;
  const auto filled = progress.rows > 0 ? progress.done * width / progress.rows : width;
  std::fprintf(stderr, "\r\033[K[%s%s] %zu of %zu  %zu passed  %zu failed  %s left", std::string(filled, '#').c_str(),
               std::string(width - filled, '.').c_str(), progress.done, progress.rows, progress.passed, progress.failed,
               progress.left_s > 0 ? clock_text(progress.left_s).c_str() : "?");
}

std::string values_text(const Row& row) {
  std::string text = "seed " + std::to_string(row.seed);
  for (const auto& [path, value] : row.values) text += "  " + path + " " + value;
  return text;
}

// Of a run before, in a folder that may hold more.
void remove_files_of_run(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::exists(folder / "sim-server.log", ignored)) return;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const auto name = entry.path().filename().string();
    const bool is_log = name.starts_with("rtcd-") && name.ends_with(".log");
    constexpr std::array names = {"omninames.err", "omninames.log", "sim-server.log", "recorder.log", "record.txt", "system.xml",
                                  "expect.yaml",   "picture.png",   "run.mcap",       "run.html",     "world"};
    if (is_log || std::ranges::find(names, name) != names.end()) fs::remove_all(entry.path(), ignored);
  }
}

// One row, with its files kept: what the command that repeats a row does.
void run_one(const Session& session, Console& console, const Campaign& campaign, const SweepCall& call) {
  if (call.row > campaign.rows())
    return console.reject({"row " + std::to_string(call.row) + ": the plan has " + std::to_string(campaign.rows()) + " rows"});
  const auto row = campaign.row(call.row);
  if (!row) return console.fail(row.error());
  const auto folder = call.keep.empty() ? "row-" + std::to_string(call.row) : call.keep;
  if (!console.json()) std::printf("row %zu  %s\n", row->number, base::printable(values_text(*row)).c_str());
  std::fflush(stdout);
  remove_files_of_run(folder);
  const auto outcome = run_row(session.orb(), campaign, *row,
                               {.folder = folder,
                                .keeps_files = true,
                                .records = call.records,
                                .page = call.pages ? folder + "/run.html" : "",
                                .command = again(call.plan, call.row)},
                               console);
  nlohmann::ordered_json json{{"row", row->number},
                              {"seed", row->seed},
                              {"key", campaign.key(*row)},
                              {"passed", outcome.run.is_passed()},
                              {"state", outcome.run.state_hash},
                              {"problem", outcome.run.problem},
                              {"simulated", outcome.run.simulated_s},
                              {"wall", outcome.run.wall_s},
                              {"folder", folder},
                              {"measures", outcome.measures}};
  if (console.json()) {
    std::cout << json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  } else {
    std::printf("%s  %.1f s simulated in %.1f s  state %s  files in %s\n", outcome.run.is_passed() ? "passed" : "FAILED",
                outcome.run.simulated_s, outcome.run.wall_s, outcome.run.state_hash.empty() ? no_state : outcome.run.state_hash.c_str(),
                base::printable(folder).c_str());
    for (const auto& [name, value] : outcome.measures) std::printf("  %s  %.6g\n", base::printable(name).c_str(), value);
  }
  std::fflush(stdout);
  for (const auto& note : outcome.run.notes) console.warn(note);
  const std::string state = outcome.run.state_hash.empty() ? no_state : outcome.run.state_hash;
  if (!call.state.empty() && call.state != state)
    console.fail({"row " + std::to_string(call.row) + ": state " + state + ", expected " + call.state});
  if (!outcome.run.problem.empty()) console.fail({outcome.run.problem});
  for (const auto& verdict : outcome.run.verdicts) {
    if (!verdict.problem.empty()) console.fail({tools::failure_text(verdict)});
  }
}

void tell(Console& console, const SweepResult& result, const SweepCall& call) {
  const auto& p = result.progress;
  const auto results = results_of(call);
  if (console.json()) {
    std::cout << nlohmann::ordered_json{{"rows", p.rows},     {"passed", p.passed},   {"failed", p.failed},
                                        {"stored", p.stored}, {"audited", p.audited}, {"different", p.different},
                                        {"wall", p.wall_s},   {"results", results},   {"interrupted", result.is_interrupted}}
                     .dump()
              << '\n';
  } else {
    const auto rate = wilson(p.passed, p.passed + p.failed);
    std::printf(
        "%zu rows: %zu passed, %zu failed, %zu were in the results; pass rate %.1f %% (95 %%: %.1f to %.1f %%); %.1f s; results in %s\n",
        p.rows, p.passed, p.failed, p.stored, rate.rate * 100, rate.low * 100, rate.high * 100, p.wall_s, base::printable(results).c_str());
    if (p.audited > 0) std::printf("audit: %zu rows run again, %zu differ\n", p.audited, p.different);
  }
  std::fflush(stdout);
  constexpr std::size_t enough = 10;
  for (std::size_t i = 0; i < result.failed.size() && i < enough; ++i) {
    const auto number = std::to_string(result.failed[i].number);
    console.warn("row " + number + ": " + result.failed[i].problem);
    console.warn("  again: " + again(call.plan, result.failed[i].number));
    const auto page = result.failed[i].folder + "/run.html";
    if (std::error_code none; call.pages && std::filesystem::is_regular_file(page, none)) console.warn("  page: " + page);
  }
  if (p.failed > enough)
    console.warn("and " + std::to_string(p.failed - enough) + " more; " +
                 base::shell_line(base::command_words({"rtse", "results"}, {results})));
  if (p.failed > 0) console.set_failed();
  if (!result.problem.empty()) console.fail({result.problem});
  for (const auto number : result.different) console.fail({"audit: row " + std::to_string(number) + " has another state than stored"});
  if (result.is_interrupted)
    console.fail(
        {"interrupted after " + std::to_string(p.done) + " of " + std::to_string(p.rows) + " rows; repeat the command to continue"});
}

// Rows that were run before are not in the results any more.
void tell_why_again(Console& console, const Progress& progress) {
  if (progress.changed.empty()) return;
  constexpr std::size_t most = 5;
  auto names = progress.changed;
  if (names.size() > most) {
    names.resize(most);
    names.push_back("and " + std::to_string(progress.changed.size() - most) + " more");
  }
  console.warn(std::to_string(progress.rows - progress.stored) +
               " rows run again, because these have changed since the results were made: " + base::join(names, ", "));
}

// "3", "1..20".
std::optional<std::pair<std::size_t, std::size_t>> parse_row_range(const std::string& text) {
  const auto dots = text.find("..");
  const auto first = base::parse_integer(text.substr(0, dots));
  const auto last = dots == std::string::npos ? first : base::parse_integer(text.substr(dots + 2));
  if (!first || !last || *first < 1 || *last < *first) return std::nullopt;
  return std::pair(static_cast<std::size_t>(*first), static_cast<std::size_t>(*last));
}

// For GNU parallel and its like: each line runs some rows and adds them to the same results. A plain shell may read them from a pipe.
void print_commands(const Campaign& campaign, const SweepCall& call) {
  const auto word = isatty(STDOUT_FILENO) ? base::shell_word : base::script_word;
  for (std::size_t first = 1; first <= campaign.rows(); first += call.chunk) {
    const auto last = std::min(campaign.rows(), first + call.chunk - 1);
    std::printf("%s sweep %s --rows %zu..%zu -o %s\n", word(base::own_program("rtse")).c_str(),
                word(fs::absolute(call.plan).string()).c_str(), first, last, word(fs::absolute(results_of(call)).string()).c_str());
  }
}

SweepOptions options_of(const Session& session, const SweepCall& call) {
  SweepOptions options;
  options.results = results_of(call);
  options.kept = fs::absolute(call.keep.empty() ? fs::path(options.results).replace_extension(".runs") : fs::path(call.keep)).string();
  options.jobs = call.jobs;
  if (const auto rows = parse_row_range(call.rows)) std::tie(options.first_row, options.last_row) = *rows;
  options.records = call.records;
  options.writes_pages = call.pages;
  options.fails_fast = call.fails_fast;
  options.call_limit = session.call_timeout();
  const auto percent = base::parse_number(call.audit.ends_with("%") ? call.audit.substr(0, call.audit.size() - 1) : call.audit);
  options.audit = percent.value_or(0) / (call.audit.ends_with("%") ? 100 : 1);
  return options;
}

SlurmOptions slurm_options_of(const SweepCall& call, const SweepOptions& options) {
  SlurmOptions slurm;
  slurm.folder = fs::absolute(call.shared.empty() ? fs::path(options.results).replace_extension(".slurm") : fs::path(call.shared)).string();
  slurm.chunk = call.chunk;
  slurm.tries = call.tries;
  slurm.options = call.sbatch;
  slurm.command = {base::own_program("rtse"), "sweep", fs::absolute(call.plan).string(), "--keep", options.kept, "-j",
                   std::to_string(call.jobs)};
  if (call.records) slurm.command.emplace_back("--record");
  if (call.pages) slurm.command.emplace_back("--page");
  return slurm;
}

void sweep_plan(const Session& session, Console& console, const SweepCall& call) {
  if (call.prints_schema) {
    std::cout << plan_schema().dump(2) << '\n';
    return;
  }
  auto plan = read_plan(call.plan);
  if (!plan) return console.reject(plan.error());
  if (const auto ready = check_programs(); !ready) return console.fail(ready.error());
  const auto campaign = Campaign::prepare(std::move(*plan));
  if (!campaign) return console.reject(campaign.error());
  base::catch_interrupts();
  if (call.engine == "parallel") return print_commands(*campaign, call);
  if (call.row > 0) return run_one(session, console, *campaign, call);
  const auto options = options_of(session, call);
  if (options.last_row > campaign->rows())
    return console.reject({"--rows " + call.rows + ": the plan has " + std::to_string(campaign->rows()) + " rows"});
  if (!call.task.empty()) {
    if (const auto done = run_task(session.orb(), *campaign, options, *parse_task(call.task), console); !done) console.fail(done.error());
    return;
  }
  if (const auto writable = base::check_writable_file(options.results); !writable) return console.reject(writable.error());
  const bool shows = isatty(2) != 0 && !console.json();
  bool has_told = false;
  const auto show = [&](const Progress& progress) {
    if (!std::exchange(has_told, true)) tell_why_again(console, progress);
    if (shows) show_progress(progress);
  };
  const auto result = call.engine == "slurm" ? slurm_sweep(*campaign, options, slurm_options_of(call, options), show)
                                             : sweep(session.orb(), *campaign, options, show, console);
  if (shows) std::fprintf(stderr, "\r\033[K");
  if (!result) return console.fail(result.error());
  tell(console, *result, call);
}

// The engine that runs the rows.
void add_engines(base::Command& command, SweepCall& call) {
  command
      .add_option("--engine", call.engine, "Engine: local; slurm: job arrays of a cluster; parallel: print command lines for GNU parallel")
      ->check(base::one_of({"local", "slurm", "parallel"}))
      ->capture_default_str();
  command.add_option("--chunk", call.chunk, "Number of rows per Slurm task or command line")
      ->check(base::integer_between(1, 1000000))
      ->capture_default_str();
  command
      .add_option("--shared", call.shared, "With --engine slurm: shared folder of all machines (default: the results' name with .slurm)")
      ->check(base::output_name());
  command.add_option("--tries", call.tries, "With --engine slurm: attempts per row if its task ends without a result")
      ->check(base::integer_between(1, 100))
      ->capture_default_str();
  command.add_option("--sbatch", call.sbatch, "With --engine slurm: an option for sbatch, e.g. --sbatch=--partition=short")
      ->allow_extra_args(false);
  command.add_option("--task", call.task, "Internal, for Slurm tasks: FOLDER:ATTEMPT:TASK")->check([](const std::string& text) {
    return parse_task(text) ? std::string() : "expected FOLDER:ATTEMPT:TASK, got " + base::in_quotes(text);
  });
}

}  // namespace

void add_sweep(base::Command& app, tools::Chosen& chosen) {
  auto* command = app.add_subcommand("sweep", "Run all rows of a plan and store their results");
  auto call = std::make_shared<SweepCall>();
  auto* plan = command->add_option("PLAN", call->plan, "Plan, YAML (docs/campaign-plan.md)")->check(base::existing_file());
  command->add_option("-j,--jobs", call->jobs, "Number of rows to run in parallel")
      ->check(base::integer_between(1, 256))
      ->capture_default_str();
  command->add_option("-o,--results", call->results, "Results file, SQLite (default: the plan's name with .db)")
      ->check(base::output_name());
  command->add_option("--keep", call->keep, "Folder for files of failed rows (default: the results' name with .runs)")
      ->check(base::output_name());
  auto* row = command->add_option("--row", call->row, "Run only this row, even if its result is stored, and keep its files")
                  ->check(base::number_between(1, 1e6));
  command->add_option("--state", call->state, "With --row: expected final state hash; -: the run must not finish")->needs(row);
  command->add_option("--rows", call->rows, "Run only the rows FIRST..LAST")->excludes(row)->check([](const std::string& text) {
    return parse_row_range(text) ? std::string() : "expected N or FIRST..LAST, got " + base::in_quotes(text);
  });
  add_engines(*command, *call);
  auto* audit = command->add_option("--audit", call->audit, "Run this fraction of the stored rows again and compare, e.g. 5% or 0.05")
                    ->excludes(row)
                    ->check([](const std::string& text) {
                      const bool is_percent = text.ends_with("%");
                      const auto number = base::parse_number(is_percent ? text.substr(0, text.size() - 1) : text);
                      return number && *number >= 0 && *number <= (is_percent ? 100 : 1)
                                 ? std::string()
                                 : "expected a fraction as 5% or 0.05, got " + base::in_quotes(text);
                    });
  command->add_flag("--record", call->records, "Record all ports of failed rows");
  command->add_flag("--page", call->pages, "Write the HTML page run.html for each failed row, in its folder of --keep");
  auto* fails_fast = command->add_flag("--fail-fast", call->fails_fast, "Start no further rows after a failure");
  command->add_flag("--schema", call->prints_schema, "Print the JSON Schema of plans");
  command->callback([&chosen, call, plan, audit, fails_fast] {
    tools::require(call->prints_schema || plan->count() > 0, "sweep", "expected a PLAN");
    tools::require(call->engine == "local" || audit->count() + fails_fast->count() == 0, "sweep",
                   "--audit and --fail-fast are of --engine local");
    chosen.needs_orb = !call->prints_schema;
    chosen.work = [call](const Session& session, Console& console) { sweep_plan(session, console, *call); };
  });
}

}  // namespace campaign
