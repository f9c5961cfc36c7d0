// hunt: looks for what breaks a plan's expectations.
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/command_line.h"
#include "base/interrupt.h"
#include "base/output_name.h"
#include "base/shell_word.h"
#include "base/text.h"
#include "campaign/hunt/hunt.h"
#include "rtse/campaign/campaign_commands.h"
#include "rtse/command.h"

namespace campaign {
namespace {

using tools::Console;
using tools::Session;

struct HuntCall {
  std::string plan, folder, budget = "10m";
  int jobs = 1;
  std::size_t cases = 0, failures = 0;
  std::int64_t seed = -1;
  bool pages = false;
};

// "90", "90s", "10m", "2h".
std::optional<double> seconds_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const char unit = text.back();
  const double factor = unit == 'h' ? 3600 : unit == 'm' ? 60 : 1;
  const auto number = base::parse_number(unit == 'h' || unit == 'm' || unit == 's' ? text.substr(0, text.size() - 1) : text);
  return number && *number > 0 && *number * factor < 1e7 ? std::optional(*number * factor) : std::nullopt;
}

nlohmann::ordered_json to_json(const FoundFailure& failure) {
  return {{"problem", failure.problem},
          {"case", failure.case_number},
          {"after", failure.after_s},
          {"deeds", failure.tried.actions()},
          {"what", text_of(failure.tried)},
          {"state", failure.state_hash},
          {"repeatable", failure.is_repeatable},
          {"plan", failure.file}};
}

void tell(const FoundFailure& failure, std::size_t number) {
  std::vector<std::string> options{"--row", "1"};
  if (!failure.state_hash.empty()) options.insert(options.end(), {"--state", failure.state_hash});
  const auto again = base::shell_line(base::command_words({"rtse", "sweep"}, {failure.file}, options));
  const char* doubt = !failure.was_repeated   ? "\n  interrupted: it may not be the simplest, and was not run again"
                      : failure.is_repeatable ? ""
                                              : "\n  it was not the same when it was run again";
  std::printf("find %zu after %.0f s, case %zu: %s\n  %s\n  %s%s\n", number, failure.after_s, failure.case_number,
              base::printable(failure.problem, "\n\t").c_str(), base::printable(text_of(failure.tried), "\n\t").c_str(), again.c_str(),
              doubt);
  std::fflush(stdout);
}

// On standard output: what was found, first as it came, then in its simplest form.
void tell_progress(const HuntProgress& progress) {
  if (progress.failure) tell(*progress.failure, progress.failures);
  if (progress.problem.empty() || progress.tries > 0) return;
  std::printf("case %zu after %.0f s: %s\n  shrinking it: searching for the simplest case that fails in the same way\n",
              progress.case_number, progress.wall_s, base::printable(progress.problem, "\n\t").c_str());
  std::fflush(stdout);
}

std::string status_line(const HuntProgress& progress, std::chrono::seconds budget) {
  char text[200];
  if (progress.problem.empty()) {
    std::snprintf(text, sizeof text, "%zu cases  %zu finds  %zu states reached  %.0f of %ld s", progress.cases, progress.failures,
                  progress.features, progress.wall_s, static_cast<long>(budget.count()));
  } else {
    std::snprintf(text, sizeof text, "shrinking case %zu: try %zu, %zu actions so far  %.0f s", progress.case_number, progress.tries,
                  progress.actions, progress.wall_s);
  }
  return text;
}

void hunt_plan(const Session& session, Console& console, const HuntCall& call) {
  auto plan = read_plan(call.plan);
  if (!plan) return console.reject(plan.error());
  if (call.seed >= 0) plan->hunt.seed = static_cast<std::uint64_t>(call.seed);
  if (const auto ready = check_programs(); !ready) return console.fail(ready.error());
  const auto campaign = Campaign::prepare(std::move(*plan));
  if (!campaign) return console.reject(campaign.error());
  base::catch_interrupts();
  HuntOptions options;
  options.budget = std::chrono::seconds(static_cast<long>(*seconds_of(call.budget)));
  options.jobs = call.jobs;
  options.max_cases = call.cases;
  options.max_failures = call.failures;
  options.folder = call.folder.empty() ? std::filesystem::path(call.plan).replace_extension(".finds").string() : call.folder;
  options.writes_pages = call.pages;
  options.call_limit = session.call_timeout();
  const bool shows = isatty(2) != 0 && !console.json();
  const auto result = hunt(
      session.orb(), *campaign, options,
      [&](const HuntProgress& progress) {
        if (shows) std::fprintf(stderr, "\r\033[K");
        if (!console.json()) tell_progress(progress);
        if (shows) std::fputs(status_line(progress, options.budget).c_str(), stderr);
      },
      console);
  if (shows) std::fprintf(stderr, "\r\033[K");
  if (!result) return console.fail(result.error());
  if (console.json()) {
    nlohmann::ordered_json failures = nlohmann::ordered_json::array();
    for (const auto& failure : result->failures) failures.push_back(to_json(failure));
    std::cout << nlohmann::ordered_json{{"cases", result->cases},
                                        {"states", result->features},
                                        {"wall", result->wall_s},
                                        {"finds", failures},
                                        {"interrupted", base::is_interrupted()}}
                     .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace)
              << '\n';
  } else {
    std::printf("%zu finds in %zu cases, %.0f s; %zu states reached\n", result->failures.size(), result->cases, result->wall_s,
                result->features);
  }
  if (!result->failures.empty()) console.set_failed();
  if (base::is_interrupted()) console.fail({"interrupted after " + std::to_string(result->cases) + " cases"});
}

}  // namespace

void add_hunt(base::Command& app, tools::Chosen& chosen) {
  auto* command = app.add_subcommand("hunt", "Search for faults, events and parameters that violate the plan");
  auto call = std::make_shared<HuntCall>();
  command->add_option("PLAN", call->plan, "Plan, YAML (docs/campaign-plan.md)")->required()->check(base::existing_file());
  command->add_option("--budget", call->budget, "Duration of the search [wall clock]: 90s, 10m, 2h")
      ->capture_default_str()
      ->check([](const std::string& text) {
        return seconds_of(text) ? std::string() : "expected a time as 90s, 10m or 2h, got " + base::in_quotes(text);
      });
  command->add_option("-j,--jobs", call->jobs, "Number of cases to run in parallel")
      ->check(base::integer_between(1, 64))
      ->capture_default_str();
  command->add_option("--cases", call->cases, "Stop after N cases")->check(base::number_between(1, 1e9));
  command->add_option("--finds", call->failures, "Stop after N failures found")->check(base::number_between(1, 1e6));
  command->add_option("--seed", call->seed, "Seed of the hunt (default: that of the plan)")->check(base::number_between(0, 1e18));
  command->add_option("-o,--folder", call->folder, "Folder for failures found (default: the plan's name with .finds)")
      ->check(base::output_name());
  command->add_flag("--page", call->pages, "Write an HTML page for each failure found, beside its plan");
  command->callback(
      [&chosen, call] { chosen.work = [call](const Session& session, Console& console) { hunt_plan(session, console, *call); }; });
}

}  // namespace campaign
