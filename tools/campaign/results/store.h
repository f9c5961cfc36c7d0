// The results of a campaign in one SQLite file (docs/campaigns-on-a-cluster.md has the schema). Stored results survive the end of the
// process at any time, also by SIGKILL. One thread at a time.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/results/database.h"
#include "campaign/rows/rows.h"
#include "campaign/run/row_run.h"

namespace campaign {

// What is kept of a run.
struct StoredRun {
  bool is_passed = false;
  std::string problem;  // of the first that was not as expected
  std::string state_hash;
  std::string folder;  // of its files; empty: there are none
  double simulated_s = 0, wall_s = 0;
};

class Store {
 public:
  static constexpr int version = 1;

  // Makes the file, or goes on with one of the same version.
  static Result<Store> open(const std::string& file);
  // Whether the file is there and its list of rows is this one.
  static bool has_list(const std::string& file, const std::string& list);

  // Begins a list of rows, and forgets the one before; the runs stay. False: the list that is called so is there already, and nobody
  // who runs some of its rows need wait for another who writes it again.
  Result<bool> begin_rows(const Plan& plan, const std::string& list);
  // Of the table of facts about the campaign; empty when it is not there.
  Result<std::string> fact(const std::string& name);
  Result<void> set(const std::string& name, const std::string& value);
  Result<void> add_row(const Row& row, const std::string& key);
  Result<void> end_rows();

  Result<std::optional<StoredRun>> run(const std::string& key);
  // At once and whole.
  Result<void> add_run(const std::string& key, const Outcome& outcome, const std::string& folder);
  Result<void> add_audit(const std::string& key, const std::string& state_hash, bool is_same);

 private:
  explicit Store(Database database) : database_(std::move(database)) {}
  Result<void> make_statements();

  Database database_;
  std::vector<Statement> statements_;
};

}  // namespace campaign
