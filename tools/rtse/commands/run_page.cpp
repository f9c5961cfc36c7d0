#include "rtse/commands/run_page.h"

#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <variant>

#include "base/child_process.h"
#include "base/shell_word.h"
#include "base/text.h"
#include "base/whole_file.h"

namespace editor {
namespace {

constexpr std::chrono::minutes longest_writing{30};

// "7", "0.05".
std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

void add_words(std::vector<std::string>& words, const RunOptionRow& row, const RunOptions& options) {
  static const RunOptions defaults;
  const std::string name = "--" + std::string(row.name);
  std::visit(
      [&](auto member) {
        const auto& value = options.*member;
        if (value == defaults.*member) return;
        if constexpr (std::is_same_v<decltype(member), bool RunOptions::*>) {
          words.push_back(name);
        } else if constexpr (std::is_same_v<decltype(member), std::vector<std::string> RunOptions::*>) {
          for (const auto& one : value)
            for (auto& word : base::option_words(name, one)) words.push_back(std::move(word));
        } else if constexpr (std::is_same_v<decltype(member), std::string RunOptions::*>) {
          for (auto& word : base::option_words(name, value)) words.push_back(std::move(word));
        } else if constexpr (std::is_same_v<decltype(member), double RunOptions::*>) {
          for (auto& word : base::option_words(name, number_text(value))) words.push_back(std::move(word));
        } else {
          for (auto& word : base::option_words(name, std::to_string(value))) words.push_back(std::move(word));
        }
      },
      row.member);
}

nlohmann::ordered_json summary_of(const RunOptions& options, const RunResult& result) {
  auto why = nlohmann::ordered_json::array();
  if (!result.problem.empty()) why.push_back(result.problem);
  for (const auto& verdict : result.verdicts) {
    if (!verdict.problem.empty()) why.push_back(failure_text(verdict));
  }
  nlohmann::ordered_json summary{{"passed", result.is_passed()},
                                 {"why", std::move(why)},
                                 {"seed", result.seed},
                                 {"hash", result.state_hash},
                                 {"command", repeating_command(options)}};
  if (!result.is_passed()) summary["at"] = result.simulated_s;
  return summary;
}

}  // namespace

std::string repeating_command(const RunOptions& options) {
  std::vector<std::string> words;
  for (const auto& row : run_option_rows) {
    if (row.repeats_run || row.name == "world" || row.name == "expect") add_words(words, row, options);
  }
  return base::shell_line(base::command_words({"rtse", "run"}, {options.system}, words));
}

RunOptions recorded_for_page(const RunOptions& options) {
  RunOptions made = options;
  if (!options.page.empty() && options.record.empty()) made.record = options.page + "." + std::to_string(::getpid()) + ".mcap";
  return made;
}

void write_page(Console& console, const RunOptions& given, const RunOptions& made, const RunResult& result) {
  if (given.page.empty()) return;
  std::error_code error;
  const std::string summary = given.page + "." + std::to_string(::getpid()) + ".json";
  const auto cleanup = [&] {
    std::filesystem::remove(summary, error);
    if (given.record.empty()) std::filesystem::remove(made.record, error);
  };
  if (!std::filesystem::exists(made.record, error)) {
    cleanup();
    // A run that did not start has said so, and with --last one that passes keeps nothing.
    if (!result.is_passed()) return;
    if (given.record_last_s > 0)
      return console.warn("page " + base::in_quotes(given.page) + ": not written, since --last keeps failed runs only");
    return console.fail({"page " + base::in_quotes(given.page) + ": the run left no recording"});
  }
  const auto text = summary_of(given, result).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  if (const auto written = base::write_whole_file(summary, text); !written) {
    cleanup();
    return console.fail(written.error());
  }
  auto child = ChildProcess::start(
      {.words = {own_program("rtse-page"), made.record, "--output", given.page, "--summary", summary, "--page-camera-rate",
                 number_text(given.page_camera_rate), "--page-limit", number_text(given.page_limit_mib)},
       .environment = {}});
  const bool is_done = child && child->wait_or_interrupt(longest_writing) == Ending::ended && child->exit_code() == 0;
  if (!is_done) {
    const auto said = child ? base::split_list(child->said(), '\n') : std::vector<std::string>{child.error().message};
    console.fail({"page " + base::in_quotes(given.page) + ": " + (said.empty() ? child->how_it_ended() : said.back())});
  } else if (!console.json()) {
    std::cout << "page " << child->said();
  }
  cleanup();
}

}  // namespace editor
