// The rows of a sweep that have to run, and their results: in the results file, and as counters. Every engine has one. Only take(), keep()
// and is_stopped() can be called from several threads.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "campaign/results/store.h"
#include "campaign/run/campaign.h"
#include "campaign/run/sweep.h"

namespace campaign {

class Tally {
 public:
  struct Todo {
    std::size_t number = 0;
    std::string stored_state;  // when it is an audit
    bool is_audit = false;
  };

  Tally(const Campaign& campaign, const SweepOptions& options, Store store, const std::function<void(const Progress&)>& show)
      : campaign_(campaign), options_(options), store_(std::move(store)), show_(show) {}

  // Rows whose key is in the results already, or comes twice, are not run again.
  Result<void> list_rows();
  const std::vector<Todo>& todo() const { return todo_; }
  // Stores what has come out of a row, and shows how far the sweep is. `folder`: of the row's files; empty: there are none.
  // Whether another process has stored it since; counts it then. Not for audits.
  bool was_stored(const Todo& todo, const std::string& key);
  void take(const Todo& todo, const std::string& key, const Outcome& outcome, const std::string& folder);
  // Stores what has come out of a row that this call has not asked for, unless it is stored already. Neither counted nor shown.
  void keep(const std::string& key, const Outcome& outcome, const std::string& folder);
  // Rows cannot be run any more, for this reason.
  void give_up(const std::string& problem);
  // Nothing more should be begun.
  bool is_stopped();
  // When all has ended. The error: the results could not be written, or it was given up.
  Result<SweepResult> result();

 private:
  using Clock = std::chrono::steady_clock;
  void take_stored(std::size_t number, const std::string& key, const StoredRun& run);
  void add(const Todo& todo, const std::string& key, const Outcome& outcome, const std::string& folder);

  const Campaign& campaign_;
  const SweepOptions& options_;
  Store store_;
  const std::function<void(const Progress&)>& show_;
  base::Turn<> telling_;  // one result at a time
  std::vector<Todo> todo_;
  std::map<std::string, std::size_t> twins_;  // by key: rows that are not run, since one of todo_ is the same
  std::size_t ended_ = 0;
  SweepResult result_;
  std::string problem_;  // why this ends before all rows have run
  Clock::time_point began_ = Clock::now();
};

}  // namespace campaign
