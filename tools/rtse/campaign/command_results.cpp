// results: what a campaign has shown, as tables, files and a page.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/command_line.h"
#include "base/output_name.h"
#include "base/text.h"
#include "base/whole_file.h"
#include "campaign/results/report.h"
#include "rtse/campaign/campaign_commands.h"
#include "rtse/command.h"

namespace campaign {
namespace {

using tools::Console;
using tools::Session;

struct ResultsCall {
  std::string file, junit, html, runs;
  std::vector<std::string> by;
  bool csv = false;
};

std::string runs_of(const ResultsCall& call) {
  if (call.runs.empty()) return std::filesystem::path(call.file).replace_extension(".runs").string();
  std::error_code absent;                                                // then there are no pictures
  return std::filesystem::weakly_canonical(call.runs, absent).string();  // whoever names a link means what it leads to
}

void show_results(Console& console, const ResultsCall& call) {
  for (const auto& file : {call.junit, call.html}) {
    if (const auto writable = file.empty() ? base::Result<void>() : base::check_writable_file(file); !writable)
      return console.reject(writable.error());
  }
  const auto results = read_results(call.file);
  if (!results) return console.reject(results.error());
  for (const auto& parameter : call.by) {
    if (std::ranges::find(results->parameters, parameter) == results->parameters.end())
      return console.reject({"--by " + base::in_quotes(parameter) + ": no varied value has this name; it has " +
                             (results->parameters.empty() ? "nothing" : base::join(results->parameters, ", "))});
  }
  if (call.csv) {
    print_csv(std::cout, *results);
  } else if (console.json()) {
    const auto rate = wilson(results->passed_count(), results->run_count());
    std::cout << nlohmann::ordered_json{{"rows", results->rows.size()},
                                        {"run", results->run_count()},
                                        {"passed", results->passed_count()},
                                        {"rate", rate.rate},
                                        {"low", rate.low},
                                        {"high", rate.high}}
                     .dump()
              << '\n';
  } else if (call.junit.empty() && call.html.empty()) {
    print_tables(std::cout, *results, call.by);
  }
  if (!call.junit.empty()) {
    if (const auto written = write_junit(*results, call.junit, runs_of(call)); !written) console.fail(written.error());
  }
  if (!call.html.empty()) {
    if (const auto written = write_html(*results, call.html, runs_of(call)); !written) console.fail(written.error());
  }
}

}  // namespace

void add_results(base::Command& app, tools::Chosen& chosen) {
  auto* command = app.add_subcommand("results", "Show the results of a campaign");
  auto call = std::make_shared<ResultsCall>();
  command->add_option("FILE", call->file, "Results file of rtse sweep")->required()->check(base::existing_file());
  command->add_option("--by", call->by, "Print pass rates by this parameter")->allow_extra_args(false);
  command->add_flag("--csv", call->csv, "Print one line per row");
  command->add_option("--junit", call->junit, "Write a test case per row (JUnit XML)")->check(base::output_name());
  command->add_option("--html", call->html, "Write one page with plots and failed runs")->check(base::output_name());
  command->add_option("--runs", call->runs,
                      "Folder of kept files (sweep --keep), for pictures in the page; default: the results' name with .runs");
  command->callback([&chosen, call] {
    chosen.needs_orb = false;
    chosen.work = [call](const Session&, Console& console) { show_results(console, *call); };
  });
}

}  // namespace campaign
