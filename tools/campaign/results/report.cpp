#include "campaign/results/report.h"

#include <algorithm>
#include <filesystem>
#include <iomanip>

#include "base/shell_word.h"
#include "base/text.h"
#include "run/junit.h"

namespace campaign {
namespace {

std::string percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f %%", fraction * 100);
  return text;
}

std::string six_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string in_csv(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

void print_rate(std::ostream& out, const std::string& name, std::size_t width, std::size_t passed, std::size_t all) {
  const auto rate = wilson(passed, all);
  out << std::left << std::setw(static_cast<int>(width)) << name << "  " << std::right << std::setw(7) << passed << " of " << std::setw(7)
      << all << "  " << std::setw(8) << percent(rate.rate) << "  " << percent(rate.low) << " to " << percent(rate.high) << '\n';
}

void print_measures(std::ostream& out, const Results& results) {
  if (results.measures.empty()) return;
  std::size_t width = 7;
  for (const auto& name : results.measures) width = std::max(width, name.size());
  out << '\n' << std::left << std::setw(static_cast<int>(width)) << "measure" << std::right;
  for (const char* head : {"rows", "least", "median", "mean", "greatest", "deviation"}) out << "  " << std::setw(10) << head;
  out << '\n';
  for (const auto& name : results.measures) {
    std::vector<double> values;
    for (const auto& row : results.rows) {
      if (const auto found = row.measures.find(name); found != row.measures.end()) values.push_back(found->second);
    }
    const auto s = summary(std::move(values));
    out << std::left << std::setw(static_cast<int>(width)) << name << std::right << "  " << std::setw(10) << s.count;
    for (const double value : {s.min, s.median, s.mean, s.max, s.deviation}) out << "  " << std::setw(10) << six_digits(value);
    out << '\n';
  }
}

void print_groups(std::ostream& out, const Results& results, const std::string& parameter) {
  const auto all = groups(results, parameter);
  std::size_t width = parameter.size();
  for (const auto& group : all) width = std::max(width, group.name.size());
  out << '\n' << parameter << '\n';
  for (const auto& group : all) print_rate(out, group.name, width, group.passed, group.rows.size());
}

// The results name the folder, so only its last part is used. Empty: there is none.
std::string page_of_row(const std::string& runs, const ResultRow& row) {
  const auto folder = std::filesystem::path(row.run->folder).filename();
  const auto page = std::filesystem::path(runs) / folder / "run.html";
  std::error_code ignored;
  return !row.run->is_passed && !folder.empty() && std::filesystem::is_regular_file(page, ignored) ? page.string() : "";
}

}  // namespace

std::string command_again(const Results& results, const ResultRow& row) {
  return base::shell_line(base::command_words({"rtse", "sweep"}, {results.plan_file}, {"--row", std::to_string(row.number)}));
}

void print_tables(std::ostream& out, const Results& results, const std::vector<std::string>& by) {
  const auto all = results.run_count();
  out << results.plan_file << ": " << results.system << " in " << results.world << ", " << results.duration << " s\n";
  print_rate(out, "passed", 6, results.passed_count(), all);
  if (all < results.rows.size()) out << results.rows.size() - all << " of " << results.rows.size() << " rows have not been run\n";
  if (results.audits > 0) out << "audits: " << results.audits << ", of which " << results.different << " differ\n";
  if (!results.unmet.empty()) out << "\nnot met in rows\n";
  for (const auto& unmet : results.unmet) out << std::setw(15) << unmet.rows << "  " << unmet.expectation << '\n';
  const auto broken = std::ranges::count_if(results.rows, [](const ResultRow& row) { return row.run && row.run->state_hash.empty(); });
  if (broken > 0) out << std::setw(15) << broken << "  (did not run to the end)\n";
  print_measures(out, results);
  for (const auto& parameter : by) print_groups(out, results, parameter);
  constexpr std::size_t enough = 10;
  std::size_t told = 0;
  for (const auto& row : results.rows) {
    if (!row.run || row.run->is_passed) continue;
    if (told == 0) out << "\nfailed\n";
    if (++told > enough) continue;
    out << "row " << row.number << ": " << row.run->problem << "\n  " << command_again(results, row) << '\n';
  }
  if (told > enough) out << "and " << told - enough << " more\n";
}

void print_csv(std::ostream& out, const Results& results) {
  out << "row,seed";
  for (const auto& name : results.parameters) {
    if (name != "seed") out << ',' << in_csv(name);
  }
  out << ",passed,problem,state,simulated_s,wall_s";
  for (const auto& name : results.measures) out << ',' << in_csv(name);
  out << "\r\n";
  for (const auto& row : results.rows) {
    if (!row.run) continue;
    out << row.number << ',' << row.seed;
    for (const auto& name : results.parameters) {
      if (name != "seed") out << ',' << in_csv(value_of(row, name));
    }
    out << ',' << (row.run->is_passed ? 1 : 0) << ',' << in_csv(row.run->problem) << ',' << row.run->state_hash << ','
        << base::format_number(row.run->simulated_s) << ',' << base::format_number(row.run->wall_s);
    for (const auto& name : results.measures) {
      const auto found = row.measures.find(name);
      out << ',' << (found == row.measures.end() ? "" : base::format_number(found->second));
    }
    out << "\r\n";
  }
}

Result<void> write_junit(const Results& results, const std::string& file, const std::string& runs) {
  using Outcome = tools::JunitCase::Outcome;
  std::vector<tools::JunitCase> cases;
  for (const auto& row : results.rows) {
    if (!row.run) continue;
    std::string name = "row " + std::to_string(row.number) + " seed " + std::to_string(row.seed);
    for (const auto& [path, value] : row.values) name += " " + path + "=" + value;
    const auto outcome = row.run->is_passed ? Outcome::passed : row.run->state_hash.empty() ? Outcome::broken : Outcome::failed;
    cases.push_back({.outcome = outcome,
                     .group = results.plan_file,
                     .name = name,
                     .wall_s = row.run->wall_s,
                     .problem = row.run->problem,
                     .details = command_again(results, row),
                     .attachment = page_of_row(runs, row)});
  }
  return tools::write_junit_suite(file, results.plan_file, cases);
}

}  // namespace campaign
