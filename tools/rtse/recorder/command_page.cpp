// page.
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/command_line.h"
#include "base/output_name.h"
#include "base/text.h"
#include "base/valid_file.h"
#include "recording/compare.h"
#include "recording/selection.h"
#include "rtse/command.h"
#include "rtse/recorder/recorder_commands.h"
#include "run/run_page.h"

namespace recorder {
namespace {

using tools::Console;
using tools::Session;

// "/A0/velocity" -> "A0"; empty: no topic of a component's port.
std::string component_of(const std::string& topic) {
  const auto end = topic.find('/', 1);
  return topic.starts_with("/sim/") || topic.starts_with("/rtc/") || end == std::string::npos ? "" : topic.substr(1, end - 1);
}

// "/A0/velocity data.vx: 0.5 and 0.4": what the page plots.
nlohmann::ordered_json plot_of(const std::string& difference) {
  const auto blank = difference.find(' '), colon = difference.find(": ", blank);
  if (blank == std::string::npos || colon == std::string::npos) return nullptr;
  const auto member = difference.substr(blank + 1, colon - blank - 1);
  if (member.find(' ') != std::string::npos) return nullptr;
  return {{"topic", difference.substr(0, blank)}, {"member", member}};
}

nlohmann::ordered_json summary_of(const Comparison& comparison) {
  nlohmann::ordered_json summary{{"why", comparison.lonely_channels}, {"failures", nlohmann::ordered_json::array()}};
  if (comparison.lonely_channels.empty() && !comparison.first)
    summary["note"] =
        (comparison.are_equal() ? "equal: " : "equal in what can be read: ") + std::to_string(comparison.samples) + " samples";
  if (!comparison.first) return summary;
  const auto& [time, tick, what] = *comparison.first;
  const auto text = "first difference at time " + base::format_number(seconds(time)) + " s" + tick + ": " + what;
  summary["why"].push_back(text);
  summary["failures"].push_back(
      {{"text", text}, {"kind", "difference"}, {"time", seconds(time)}, {"subject", component_of(what.substr(0, what.find(' ')))}});
  summary["plot"] = plot_of(what);
  return summary;
}

void write_page(Console& console, const CompareOptions& options, tools::PageCall page) {
  nlohmann::ordered_json summary = nlohmann::ordered_json::object();
  if (!options.second.empty()) {
    const auto comparison = compare(options, console);
    if (!comparison) return console.fail(comparison.error());
    for (const auto& line : comparison->not_compared) console.warn(line);
    summary = summary_of(*comparison);
  }
  page.recording = options.first;
  page.other = options.second;
  const auto written = tools::write_run_page(page, summary);
  if (!written) return console.fail(written.error());
  if (!console.json()) std::cout << *written;
}

}  // namespace

void add_page(base::Command& app, tools::Chosen& chosen) {
  auto* command = app.add_subcommand("page", "Write a recording, or two to compare, as one HTML page for any browser");
  auto options = std::make_shared<CompareOptions>();
  auto page = std::make_shared<tools::PageCall>();
  command->add_option("A", options->first, "Recording")->required()->check(base::valid_file(recording_format_problem));
  command->add_option("B", options->second, "Recording to compare with; its models are shown as ghosts")
      ->check(base::valid_file(recording_format_problem));
  command->add_option("-o,--output", page->file, "HTML file to write")->required()->check(base::output_name());
  tools::add_page_options(*command, *page);
  command->add_option("--ignore", options->tolerated.ignored, "Members to ignore, e.g. tm")->allow_extra_args(false);
  command->callback([&chosen, options, page] {
    chosen.needs_orb = false;
    chosen.work = [options, page](const Session&, Console& console) { write_page(console, *options, *page); };
  });
}

}  // namespace recorder
