// Runs all rows of a campaign with N parallel workers and stores the results. Called from one thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <functional>
#include <string>

#include "campaign/results/store.h"
#include "campaign/run/campaign.h"
#include "campaign/run/row_run.h"

namespace campaign {

struct SweepOptions {
  std::string results;  // SQLite file
  std::string kept;     // folder for the files of rows that fail
  int jobs = 1;
  double audit = 0;                         // the fraction of stored rows that is run again
  std::size_t first_row = 1, last_row = 0;  // only these; 0: to the end
  bool records = false;
  bool writes_pages = false;  // run.html beside the other files of a row that fails
  bool fails_fast = false;    // no new row after one that failed
  std::chrono::milliseconds call_limit{1000};
};

struct Progress {
  std::size_t rows = 0, done = 0;  // of this call: those in the results already count as done
  std::size_t passed = 0, failed = 0;
  std::size_t stored = 0;  // of these: not run again
  std::size_t audited = 0, different = 0;
  double wall_s = 0;
  double left_s = 0;                   // an estimate; 0: not known yet
  std::vector<std::string> changed{};  // files and the like, since the results were made: why rows run again
};

struct FailedRow {
  std::size_t number = 0;
  std::string problem;
  std::string folder;  // of its files; empty: there are none
};

struct SweepResult {
  Progress progress;
  std::vector<FailedRow> failed;       // the first hundred
  std::vector<std::size_t> different;  // audited rows with another state
  std::string problem;                 // why rows have no result
  bool is_interrupted = false;
};

// The command that repeats a row of a plan.
std::string again(const std::string& plan, std::size_t row);
// Of a row whose files are in `folder`.
RowRunOptions row_options(const Campaign& campaign, const SweepOptions& options, std::size_t row, const std::string& folder,
                          const tools::PreforkServers* prefork);
// Of the files of a row, in the folder for kept files.
std::string folder_name(std::size_t number, const std::string& key);
// The folder for kept files. The error: it cannot be made, or its disk is full.
Result<void> make_kept(const SweepOptions& options);

// `show` is called after every row, one call at a time; `reporter` receives what the runs report.
Result<SweepResult> sweep(CORBA::ORB_ptr orb, const Campaign& campaign, const SweepOptions& options,
                          const std::function<void(const Progress&)>& show, tools::Reporter& reporter);

}  // namespace campaign
