#include "run/sweep.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/guarded.h"
#include "base/text.h"
#include "remote.h"
#include "rows/random.h"
#include "run/interrupt.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_failed_told = 100;

class Sweep {
 public:
  Sweep(CORBA::ORB_ptr orb, const Campaign& campaign, const SweepOptions& options, Store store,
        const std::function<void(const Progress&)>& show)
      : orb_(orb), campaign_(campaign), options_(options), store_(std::move(store)), show_(show) {}

  Result<SweepResult> go() {
    if (const auto listed = list_rows(); !listed) return listed.error();
    show_(result_.progress);
    editor::in_parallel(
        todo_.size(), options_.call_limit, [this](std::size_t i) { work(todo_[i]); }, static_cast<std::size_t>(options_.jobs));
    if (!problem_.empty()) return Error{problem_};
    result_.is_interrupted = editor::is_interrupted();
    result_.progress.wall_s = seconds_since(began_);
    std::ranges::sort(result_.failed, {}, &FailedRow::number);
    std::error_code ignored;
    fs::remove(options_.kept, ignored);  // when it is empty
    return result_;
  }

 private:
  struct Todo {
    std::size_t number = 0;
    std::string stored_state;  // when it is an audit
    bool is_audit = false;
  };

  static double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

  // Rows whose key is there already, or comes twice, are not run again.
  Result<void> list_rows() {
    if (const auto begun = store_.begin_rows(campaign_.plan()); !begun) return begun;
    std::set<std::string> keys;
    for (std::size_t number = 1; number <= campaign_.rows(); ++number) {
      const auto row = campaign_.row(number);
      if (!row) return Error{"row " + std::to_string(number) + ": " + row.error().message};
      const auto key = campaign_.key(*row);
      if (const auto added = store_.add_row(*row, key); !added) return added;
      const auto run = store_.run(key);
      if (!run) return run.error();
      if (number < options_.first_row || (options_.last_row > 0 && number > options_.last_row)) continue;
      ++result_.progress.rows;
      if (*run) {
        take_stored(number, key, **run);
      } else if (keys.insert(key).second) {
        todo_.push_back({number, "", false});
      } else {
        ++result_.progress.done;  // its twin is run
      }
    }
    return store_.end_rows();
  }

  void take_stored(std::size_t number, const std::string& key, const StoredRun& run) {
    auto& progress = result_.progress;
    ++progress.done;
    ++progress.stored;
    ++(run.is_passed ? progress.passed : progress.failed);
    if (!run.is_passed && result_.failed.size() < most_failed_told) result_.failed.push_back({number, run.problem});
    if (Random(options_.results.size(), key).uniform() < options_.audit) todo_.push_back({number, run.state_hash, true});
  }

  void work(const Todo& todo) {
    if (editor::is_interrupted() || is_stopped()) return;
    const auto row = campaign_.row(todo.number);
    if (!row) return;  // list_rows() has made it already
    const auto key = campaign_.key(*row);
    const auto name = "row-" + std::to_string(todo.number) + "-" + key.substr(0, 8);
    const auto folder = options_.kept + "/" + name + (todo.is_audit ? "-audit" : "");
    std::error_code ignored;
    fs::remove_all(folder, ignored);  // of a call that was killed
    const auto outcome = run_row(orb_, campaign_, *row, {.folder = folder, .keeps_files = false, .records = options_.records});
    if (editor::is_interrupted() && !outcome.problem.empty()) {
      fs::remove_all(folder, ignored);
      return;
    }
    take(todo, key, outcome, outcome.is_passed() ? "" : folder);
  }

  bool is_stopped() {
    const auto mine = telling_.take();
    return !problem_.empty() || (options_.fails_fast && result_.progress.failed > 0);
  }

  void take(const Todo& todo, const std::string& key, const Outcome& outcome, const std::string& folder) {
    const auto mine = telling_.take();
    auto& progress = result_.progress;
    if (todo.is_audit) {
      const bool is_same = outcome.state_hash == todo.stored_state;
      ++progress.audited;
      if (!is_same) {
        ++progress.different;
        result_.different.push_back(todo.number);
      }
      if (const auto added = store_.add_audit(key, outcome.state_hash, is_same); !added && problem_.empty())
        problem_ = added.error().message;
    } else {
      if (const auto added = store_.add_run(key, outcome, folder); !added && problem_.empty()) problem_ = added.error().message;
      ++progress.done;
      ++(outcome.is_passed() ? progress.passed : progress.failed);
      if (!outcome.is_passed() && result_.failed.size() < most_failed_told)
        result_.failed.push_back({todo.number, outcome.first_problem()});
    }
    ++ended_;
    progress.wall_s = seconds_since(began_);
    progress.left_s = progress.wall_s / static_cast<double>(ended_) * static_cast<double>(todo_.size() - ended_);
    show_(progress);
  }

  CORBA::ORB_ptr orb_;
  const Campaign& campaign_;
  const SweepOptions& options_;
  Store store_;
  const std::function<void(const Progress&)>& show_;
  base::Turn<> telling_;  // one result at a time
  std::vector<Todo> todo_;
  std::size_t ended_ = 0;
  SweepResult result_;
  std::string problem_;  // of the store
  Clock::time_point began_ = Clock::now();
};

}  // namespace

Result<SweepResult> sweep(CORBA::ORB_ptr orb, const Campaign& campaign, const SweepOptions& options,
                          const std::function<void(const Progress&)>& show) {
  std::error_code error;
  fs::create_directories(options.kept, error);
  if (error) return Error{"folder " + base::in_quotes(options.kept) + ": " + error.message()};
  constexpr std::uintmax_t least_space = 32U << 20U;
  if (const auto space = fs::space(options.kept, error); !error && space.available < least_space)
    return Error{"folder " + base::in_quotes(options.kept) + ": the disk has less than 32 MiB left"};
  auto store = Store::open(options.results);
  if (!store) return store.error();
  return Sweep(orb, campaign, options, std::move(*store), show).go();
}

}  // namespace campaign
