#include "campaign/run/tally.h"

#include <algorithm>
#include <utility>

#include "base/interrupt.h"
#include "base/random.h"

namespace campaign {
namespace {

constexpr std::size_t max_failed_told = 100;

}  // namespace

Result<void> Tally::list_rows() {
  const auto parts = store_.fact("parts");
  if (!parts) return parts.error();
  const auto begun = store_.begin_rows(campaign_.plan(), campaign_.list_key());
  if (!begun) return begun.error();
  if (const auto kept = *begun ? store_.set("parts", campaign_.parts()) : Result<void>(); !kept) return kept.error();
  std::set<std::string> keys;
  for (std::size_t number = 1; number <= campaign_.rows(); ++number) {
    const auto row = campaign_.row(number);
    if (!row) return Error{"row " + std::to_string(number) + ": " + row.error().message};
    const auto key = campaign_.key(*row);
    if (const auto added = *begun ? store_.add_row(*row, key) : Result<void>(); !added) return added;
    const auto run = store_.run(key);
    if (!run) return run.error();
    if (number < options_.first_row || (options_.last_row > 0 && number > options_.last_row)) continue;
    ++result_.progress.rows;
    if (*run) {
      take_stored(number, key, **run);
    } else if (keys.insert(key).second) {
      todo_.push_back({number, "", false});
    } else {
      ++twins_[key];
    }
  }
  if (const auto ended = store_.end_rows(); !ended) return ended;
  if (!parts->empty() && !todo_.empty()) result_.progress.changed = changed_parts(*parts, campaign_.parts());
  show_(result_.progress);
  return {};
}

void Tally::take_stored(std::size_t number, const std::string& key, const StoredRun& run) {
  auto& progress = result_.progress;
  ++progress.done;
  ++progress.stored;
  ++(run.is_passed ? progress.passed : progress.failed);
  if (!run.is_passed && result_.failed.size() < max_failed_told) result_.failed.push_back({number, run.problem, run.folder});
  if (base::Random(options_.results.size(), key).uniform() < options_.audit) todo_.push_back({number, run.state_hash, true});
}

void Tally::give_up(const std::string& problem) {
  const auto mine = telling_.take();
  if (problem_.empty()) problem_ = problem;
}

bool Tally::is_stopped() {
  const auto mine = telling_.take();
  return !problem_.empty() || (options_.fails_fast && result_.progress.failed > 0);
}

void Tally::add(const Todo& todo, const std::string& key, const Outcome& outcome, const std::string& folder) {
  auto& progress = result_.progress;
  const bool was_run = outcome.run.has_begun || outcome.run.problem.empty();
  if (todo.is_audit && !was_run) return;
  if (todo.is_audit) {
    const bool is_same = outcome.run.state_hash == todo.stored_state;
    ++progress.audited;
    if (!is_same) {
      ++progress.different;
      result_.different.push_back(todo.number);
    }
    if (const auto added = store_.add_audit(key, outcome.run.state_hash, is_same); !added && problem_.empty())
      problem_ = added.error().message;
    return;
  }
  // What the machine did not let begin is run again by the next call.
  const auto added = was_run ? store_.add_run(key, outcome, folder) : Result<void>();
  if (!added && problem_.empty()) problem_ = added.error().message;
  const auto twins = twins_.find(key);
  const std::size_t rows = 1 + (twins == twins_.end() ? 0 : twins->second);
  progress.done += rows;
  (outcome.run.is_passed() ? progress.passed : progress.failed) += rows;
  if (!outcome.run.is_passed() && result_.failed.size() < max_failed_told)
    result_.failed.push_back({todo.number, outcome.run.first_problem(), folder});
}

bool Tally::was_stored(const Todo& todo, const std::string& key) {
  const auto mine = telling_.take();
  if (todo.is_audit) return false;
  const auto run = store_.run(key);
  if (!run || !*run) return false;
  auto& progress = result_.progress;
  const auto twins = twins_.find(key);
  const std::size_t rows = 1 + (twins == twins_.end() ? 0 : twins->second);
  progress.done += rows;
  progress.stored += rows;
  ((*run)->is_passed ? progress.passed : progress.failed) += rows;
  if (!(*run)->is_passed && result_.failed.size() < max_failed_told)
    result_.failed.push_back({todo.number, (*run)->problem, (*run)->folder});
  ++ended_;
  show_(progress);
  return true;
}

void Tally::take(const Todo& todo, const std::string& key, const Outcome& outcome, const std::string& folder) {
  const auto mine = telling_.take();
  add(todo, key, outcome, folder);
  ++ended_;
  auto& progress = result_.progress;
  progress.wall_s = std::chrono::duration<double>(Clock::now() - began_).count();
  progress.left_s = progress.wall_s / static_cast<double>(ended_) * static_cast<double>(todo_.size() - ended_);
  show_(progress);
}

void Tally::keep(const std::string& key, const Outcome& outcome, const std::string& folder) {
  const auto mine = telling_.take();
  const auto run = store_.run(key);
  if (run && *run) return;
  const auto added = run ? store_.add_run(key, outcome, folder) : run.error();
  if (!added && problem_.empty()) problem_ = added.error().message;
}

Result<SweepResult> Tally::result() {
  const auto mine = telling_.take();
  if (!problem_.empty()) return Error{problem_};
  result_.is_interrupted = base::is_interrupted();
  result_.progress.wall_s = std::chrono::duration<double>(Clock::now() - began_).count();
  std::ranges::sort(result_.failed, {}, &FailedRow::number);
  return result_;
}

}  // namespace campaign
