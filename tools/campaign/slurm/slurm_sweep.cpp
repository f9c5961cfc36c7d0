#include "campaign/slurm/slurm_sweep.h"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>

#include "base/interrupt.h"
#include "base/shell_word.h"
#include "base/text.h"
#include "campaign/run/tally.h"
#include "campaign/slurm/queue.h"
#include "campaign/slurm/task_folder.h"

namespace campaign {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto queue_timeout = 10min;  // for a controller that does not answer
constexpr auto cancel_timeout = 2min;  // Slurm gives a task its KillWait, 30 s
constexpr std::chrono::milliseconds shortest_pause = 200ms, longest_pause = 10s;

// Nobody tells when a job of Slurm has ended, or a file of another machine has grown.
void pause(std::chrono::milliseconds time, bool ends_on_interrupt) {
  pollfd event{ends_on_interrupt ? base::interrupt_handle() : -1, POLLIN, 0};
  poll(&event, 1, static_cast<int>(time.count()));
}

class SlurmSweep {
 public:
  SlurmSweep(const Campaign& campaign, const SweepOptions& options, const SlurmOptions& slurm, Tally& tally)
      : campaign_(campaign), options_(options), slurm_(slurm), tally_(tally), folder_(slurm.folder) {}

  // What the rows without a result have met with; empty: there are none, or an interrupt.
  Result<std::string> go() {
    if (const auto listed = list_missing(); !listed) return listed.error();
    if (missing_.empty() && !fs::exists(slurm_.folder)) return std::string();
    if (const auto opened = open_folder(); !opened) return opened.error();
    gather();
    // Tasks of a call that was killed; of no use when nothing is missing, but for what they have found by then.
    if (const auto ended = missing_.empty() ? cancel() : await_tasks(); !ended) return ended.error();
    gather();
    auto chunk = slurm_.chunk;
    for (int tried = 0; tried < slurm_.tries && !missing_.empty() && !is_over(); ++tried) {
      if (const auto begun = submit(std::max(chunk, least_chunk())); !begun) return begun.error();
      if (const auto ended = await_tasks(); !ended) return ended.error();
      chunk = std::max<std::size_t>(1, chunk / 10);  // a row that takes its task down takes fewer others with it
    }
    if (missing_.empty()) folder_.remove();
    return missing_.empty() || base::is_interrupted() ? std::string() : what_is_missing();
  }

 private:
  bool is_over() { return base::is_interrupted() || tally_.is_stopped(); }
  std::size_t least_chunk() const { return (missing_.size() + slurm::max_tasks - 1) / slurm::max_tasks; }

  Result<void> list_missing() {
    for (const auto& todo : tally_.todo()) {
      const auto row = campaign_.row(todo.number);
      if (!row) return row.error();
      missing_.emplace(campaign_.key(*row), &todo);
    }
    if (slurm_.chunk >= least_chunk()) return {};
    return Error{"--chunk " + std::to_string(slurm_.chunk) + ": " + std::to_string(missing_.size()) + " rows would be more than " +
                 std::to_string(slurm::max_tasks) + " tasks; expected at least " + std::to_string(least_chunk())};
  }

  // What tasks of another plan, or of other programs, would find is of no use any more.
  Result<void> open_folder() {
    if (const auto opened = folder_.open(campaign_.base_key()); !opened) return opened;
    if (!folder_.is_other()) return {};
    if (const auto cancelled = cancel(); !cancelled) return cancelled;
    folder_.remove();
    folder_ = TaskFolder(slurm_.folder);
    return folder_.open(campaign_.base_key());
  }

  void gather() {
    for (auto& line : folder_.news()) {
      const auto found = missing_.find(line.key);
      if (found == missing_.end()) {  // known already, or of a row that another call has asked for
        tally_.keep(line.key, line.outcome, line.folder);
        continue;
      }
      tally_.take(*found->second, line.key, line.outcome, line.folder);
      missing_.erase(found);
    }
  }

  // The commands of Slurm may fail while its controller is started again.
  Result<std::size_t> count_until_queue_timeout(bool ends_on_interrupt) {
    const auto deadline = Clock::now() + queue_timeout;
    for (;;) {
      auto counted = slurm::count(folder_.name());
      if (counted || Clock::now() > deadline || (ends_on_interrupt && is_over())) return counted;
      pause(1s, ends_on_interrupt);
    }
  }

  Result<void> await_tasks() {
    const auto began = Clock::now();
    for (;;) {
      if (is_over()) {
        const auto cancelled = cancel();
        gather();
        return cancelled;
      }
      const auto left = count_until_queue_timeout(true);
      gather();
      if (left && *left == 0) return {};
      if (!left && !is_over()) return Error{left.error().message + "; the tasks continue; repeat the command to collect their results"};
      const auto past = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - began);
      pause(std::clamp(past / 20, shortest_pause, longest_pause), true);
    }
  }

  Result<void> cancel() {
    if (const auto cancelled = slurm::cancel(folder_.name()); !cancelled) return cancelled;
    for (const auto deadline = Clock::now() + cancel_timeout; Clock::now() < deadline; pause(shortest_pause, false)) {
      const auto left = slurm::count(folder_.name());
      if (left && *left == 0) return {};
    }
    return Error{"jobs " + folder_.name() + ": are still there after scancel; " +
                 base::shell_line({"scancel", "--name=" + folder_.name()})};
  }

  std::string script(int attempt) const {
    std::string command;
    for (const auto& word : slurm_.command) command += base::script_word(word) + " ";
    const auto number = std::to_string(attempt);
    return "#!/bin/sh\n# A task of rtse sweep --engine slurm. $1: the number of its array's first task.\ntask=$(($1 + "
           "SLURM_ARRAY_TASK_ID))\n"
           "exec >>" +
           base::script_word(slurm_.folder + "/logs/" + number + "-") + "$task 2>&1\nexec " + command + "--task " +
           base::script_word(slurm_.folder + ":" + number + ":") + "$task\n";
  }

  Result<void> submit(std::size_t chunk) {
    std::vector<std::size_t> rows;
    for (const auto& [key, todo] : missing_) rows.push_back(todo->number);
    std::ranges::sort(rows);
    std::vector<RowNumbers> tasks;
    for (std::size_t i = 0; i < rows.size(); i += chunk)
      tasks.emplace_back(rows.begin() + static_cast<long>(i), rows.begin() + static_cast<long>(std::min(rows.size(), i + chunk)));
    const auto attempt = folder_.begin_attempt(tasks, script(folder_.attempts() + 1));
    if (!attempt) return attempt.error();
    last_tasks_ = std::move(tasks);
    for (std::size_t first = 0; first < last_tasks_.size(); first += slurm::max_in_array) {
      const auto submitted = slurm::submit({.name = folder_.name(),
                                            .script = folder_.script(*attempt),
                                            .first = first,
                                            .count = std::min(slurm::max_in_array, last_tasks_.size() - first),
                                            .jobs = options_.jobs,
                                            .options = slurm_.options});
      if (submitted) continue;
      if (first > 0) static_cast<void>(cancel());
      return submitted;
    }
    return {};
  }

  // Of the first one, with what its task said last.
  std::string what_is_missing() const {
    std::size_t number = campaign_.rows();
    for (const auto& [key, todo] : missing_) number = std::min(number, todo->number);
    std::string said, log;
    for (std::size_t task = 0; task < last_tasks_.size(); ++task) {
      if (std::ranges::find(last_tasks_[task], number) != last_tasks_[task].end()) log = folder_.log(folder_.attempts(), task);
    }
    std::ifstream in(log);
    for (std::string line; std::getline(in, line);) said = line.empty() ? said : line;
    return "row " + std::to_string(number) + ": its task has ended " + std::to_string(slurm_.tries) + " times without its result" +
           (missing_.size() > 1 ? ", and those of " + std::to_string(missing_.size() - 1) + " more rows" : "") +
           (said.empty() ? "; see sacct --name=" + folder_.name() : ": " + said.substr(0, 300));
  }

  const Campaign& campaign_;
  const SweepOptions& options_;
  const SlurmOptions& slurm_;
  Tally& tally_;
  TaskFolder folder_;
  std::map<std::string, const Tally::Todo*> missing_;  // by key
  std::vector<RowNumbers> last_tasks_;
};

}  // namespace

Result<SweepResult> slurm_sweep(const Campaign& campaign, const SweepOptions& options, const SlurmOptions& slurm,
                                const std::function<void(const Progress&)>& show) {
  if (const auto there = slurm::check(); !there) return there.error();
  if (const auto made = make_kept(options); !made) return made.error();
  auto store = Store::open(options.results);
  if (!store) return store.error();
  Tally tally(campaign, options, std::move(*store), show);
  if (const auto listed = tally.list_rows(); !listed) return listed.error();
  const auto problem = SlurmSweep(campaign, options, slurm, tally).go();
  std::error_code ignored;
  fs::remove(options.kept, ignored);  // when it is empty
  auto result = tally.result();
  if (result && !problem) result->problem = problem.error().message;
  if (result && problem) result->problem = *problem;
  return result;
}

}  // namespace campaign
