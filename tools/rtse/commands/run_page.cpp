#include "rtse/commands/run_page.h"

#include <unistd.h>

#include <filesystem>
#include <iostream>
#include <variant>

#include "base/interrupt.h"
#include "base/shell_word.h"
#include "base/text.h"

namespace tools {
namespace {

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
          for (auto& word : base::option_words(name, base::format_number(value))) words.push_back(std::move(word));
        } else {
          for (auto& word : base::option_words(name, std::to_string(value))) words.push_back(std::move(word));
        }
      },
      row.member);
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

void WrittenPage::begin() {
  if (given_.page.empty() || made_.record_last_s > 0) return;
  if (auto started = PageBesideRun::start(call())) beside_.emplace(std::move(*started));
}

bool WrittenPage::end(Console& console, const RunResult& result) {
  if (given_.page.empty()) return false;
  std::error_code error;
  if (!std::filesystem::exists(made_.record, error)) {
    // A run that did not start has said so, and with --last one that passes keeps nothing.
    const auto page = "page " + base::in_quotes(given_.page);
    if (result.is_passed() && given_.record_last_s > 0) console.warn(page + ": not written, since --last keeps failed runs only");
    if (result.is_passed() && given_.record_last_s <= 0) console.fail({page + ": the run left no recording"});
    return false;
  }
  const auto summary = page_summary(result, repeating_command(given_));
  const auto written = beside_ ? beside_->finish(summary) : write_run_page(call(), summary);
  const bool is_kept = !written && !base::is_interrupted();
  if (given_.record.empty() && !is_kept) std::filesystem::remove(made_.record, error);
  if (!written) {
    const bool names_it = given_.record.empty() && is_kept;
    console.fail({written.error().message + (names_it ? "; the recording is kept: " + made_.record : "")});
    return false;
  }
  if (!console.json()) std::cout << "page " << *written;
  return true;
}

}  // namespace tools
