#include "campaign/results/reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/text.h"

namespace campaign {
namespace {

using RowsByKey = std::map<std::string, std::vector<std::size_t>>;

// What is kept of a file, all its tables together.
class Budget {
 public:
  static constexpr std::size_t max_names = 1000;

  explicit Budget(Database& database) : database_(database) {}

  // `copies` says how often what is in a row is kept, before `take` keeps it.
  template <class Copies, class Take>
  Result<void> for_rows(const std::string& sql, Copies copies, Take take) {
    auto statement = database_.prepare(sql);
    if (!statement) return statement.error();
    for (;;) {
      const auto more = statement->next();
      if (!more) return more.error();
      if (!*more) return {};
      std::size_t text = 0;
      for (int column = 0; column < statement->columns(); ++column) text += statement->size(column);
      const std::size_t count = std::max<std::size_t>(1, copies(*statement));
      values_ += count;
      text_ += text * count;
      if (text_ > max_text) return too_much("1 GiB of text");
      if (values_ > max_values) return too_much("30 million values");
      take(*statement);
    }
  }
  template <class Take>
  Result<void> for_rows(const std::string& sql, Take take) {
    return for_rows(
        sql, [](const Statement&) { return std::size_t{1}; }, take);
  }
  Result<void> check_names(const std::set<std::string>& names) const {
    return names.size() > max_names ? too_much("1000 parameters or measures") : Result<void>();
  }
  Database& database() { return database_; }

 private:
  static constexpr std::size_t max_values = 30'000'000, max_text = std::size_t{1} << 30;

  Result<void> too_much(const std::string& what) const {
    return Error{"results " + base::in_quotes(database_.file()) + ": hold more than " + what};
  }

  Database& database_;
  std::size_t values_ = 0, text_ = 0;
};

Result<void> read_facts(Budget& budget, Results& results) {
  std::string version;
  const auto read = budget.for_rows("SELECT name, value FROM campaign", [&](Statement& row) {
    const auto name = row.text(0);
    if (name == "version") version = row.text(1);
    if (name == "plan_file") results.plan_file = row.text(1);
    if (name == "system") results.system = row.text(1);
    if (name == "world") results.world = row.text(1);
    if (name == "duration") results.duration = row.text(1);
  });
  if (!read) return read;
  if (version != std::to_string(Store::version))
    return Error{"results " + base::in_quotes(budget.database().file()) + ": are of version " + base::in_quotes(version) + ", expected " +
                 std::to_string(Store::version)};
  return {};
}

Result<void> read_rows(Budget& budget, Results& results, RowsByKey& by_key) {
  std::map<std::int64_t, std::size_t> by_number;
  std::set<std::uint64_t> seeds;
  auto read = budget.for_rows("SELECT number, key, seed FROM rows ORDER BY number", [&](Statement& row) {
    by_number[row.integer(0)] = results.rows.size();
    by_key[row.text(1)].push_back(results.rows.size());
    results.rows.push_back({static_cast<std::size_t>(row.integer(0)), row.text(1), static_cast<std::uint64_t>(row.integer(2)), {}, {}, {}});
    seeds.insert(results.rows.back().seed);
  });
  if (!read) return read;
  if (seeds.size() > 1) results.parameters.emplace_back("seed");
  std::set<std::string> names;
  read = budget.for_rows("SELECT number, name, value FROM parameters", [&](Statement& row) {
    const auto found = by_number.find(row.integer(0));
    if (found == by_number.end()) return;
    results.rows[found->second].values[row.text(1)] = row.text(2);
    if (names.size() <= Budget::max_names) names.insert(row.text(1));
  });
  if (!read) return read;
  if (const auto checked = budget.check_names(names); !checked) return checked;
  results.parameters.insert(results.parameters.end(), names.begin(), names.end());
  return read;
}

Result<void> read_runs(Budget& budget, Results& results, const RowsByKey& by_key) {
  // A file of ours has each key once.
  const auto copies = [&](const Statement& row) {
    const auto found = by_key.find(row.text(0));
    return found == by_key.end() ? std::size_t{0} : found->second.size();
  };
  auto read = budget.for_rows("SELECT key, passed, problem, state, folder, simulated, wall FROM runs", copies, [&](Statement& row) {
    const auto found = by_key.find(row.text(0));
    if (found == by_key.end()) return;
    for (const auto place : found->second)
      results.rows[place].run = StoredRun{row.integer(1) != 0, row.text(2), row.text(3), row.text(4), row.number(5), row.number(6)};
  });
  if (!read) return read;
  std::set<std::string> names;
  read = budget.for_rows("SELECT key, name, value FROM measures", copies, [&](Statement& row) {
    const auto found = by_key.find(row.text(0));
    if (found == by_key.end()) return;
    for (const auto place : found->second) results.rows[place].measures[row.text(1)] = row.number(2);
    if (names.size() <= Budget::max_names) names.insert(row.text(1));
  });
  if (!read) return read;
  if (const auto checked = budget.check_names(names); !checked) return checked;
  results.measures.assign(names.begin(), names.end());
  const std::string unmet =
      "SELECT v.expectation, COUNT(*) FROM verdicts v JOIN rows r ON r.key = v.key WHERE v.problem <> '' GROUP BY 1 ORDER BY 2 DESC, 1";
  read = budget.for_rows(unmet, [&](Statement& row) { results.unmet.push_back({row.text(0), static_cast<std::size_t>(row.integer(1))}); });
  if (!read) return read;
  return budget.for_rows("SELECT COUNT(*), COALESCE(SUM(same = 0), 0) FROM audits", [&](Statement& row) {
    results.audits = static_cast<std::size_t>(row.integer(0));
    results.different = static_cast<std::size_t>(row.integer(1));
  });
}

void count(Group& group) {
  for (const auto* row : group.rows) group.passed += row->run->is_passed ? 1U : 0U;
  group.rate = wilson(group.passed, group.rows.size());
}

std::vector<Group> ranges_of(const std::vector<std::pair<double, const ResultRow*>>& numbers) {
  constexpr std::size_t pieces = 8;
  double least = numbers.front().first, greatest = least;
  for (const auto& [number, row] : numbers) least = std::min(least, number), greatest = std::max(greatest, number);
  const double width = (greatest - least) / pieces;
  std::vector<Group> all(pieces);
  for (std::size_t i = 0; i < pieces; ++i) {
    char text[64];
    std::snprintf(text, sizeof text, "%.4g to %.4g", least + static_cast<double>(i) * width, least + static_cast<double>(i + 1) * width);
    all[i].name = text;
  }
  for (const auto& [number, row] : numbers)
    all[std::min(pieces - 1, static_cast<std::size_t>((number - least) / width))].rows.push_back(row);
  return all;
}

}  // namespace

std::size_t Results::run_count() const {
  return static_cast<std::size_t>(std::ranges::count_if(rows, [](const ResultRow& row) { return row.run.has_value(); }));
}

std::size_t Results::passed_count() const {
  return static_cast<std::size_t>(std::ranges::count_if(rows, [](const ResultRow& row) { return row.run && row.run->is_passed; }));
}

Result<Results> read_results(const std::string& file, const ReadLimits& limits) {
  auto database = Database::open(file, Database::Access::read, limits);
  if (!database) return database.error();
  Results results;
  results.file = file;
  Budget budget(*database);
  if (const auto read = read_facts(budget, results); !read) return read.error();
  RowsByKey by_key;
  if (const auto read = read_rows(budget, results, by_key); !read) return read.error();
  if (const auto read = read_runs(budget, results, by_key); !read) return read.error();
  return results;
}

std::string value_of(const ResultRow& row, const std::string& parameter) {
  if (parameter == "seed") return std::to_string(row.seed);
  const auto found = row.values.find(parameter);
  return found == row.values.end() ? "" : found->second;
}

std::vector<Group> groups(const Results& results, const std::string& parameter) {
  constexpr std::size_t max_single_values = 12;
  std::map<std::string, Group> by_value;
  std::vector<std::pair<double, const ResultRow*>> numbers;
  bool are_numbers = true;
  for (const auto& row : results.rows) {
    if (!row.run) continue;
    const auto value = value_of(row, parameter);
    const auto number = base::parse_number(value);
    are_numbers = are_numbers && number;
    if (number) numbers.emplace_back(*number, &row);
    by_value[value].name = value;
    by_value[value].rows.push_back(&row);
  }
  std::vector<Group> all;
  if (are_numbers && by_value.size() > max_single_values) {
    all = ranges_of(numbers);
  } else {
    for (auto& [value, group] : by_value) all.push_back(std::move(group));
    if (are_numbers) std::ranges::sort(all, {}, [](const Group& group) { return base::parse_number(group.name).value_or(0); });
  }
  for (auto& group : all) count(group);
  return all;
}

}  // namespace campaign
