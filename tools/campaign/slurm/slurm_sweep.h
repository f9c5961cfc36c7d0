// A sweep whose rows run as job arrays of Slurm. The caller submits tasks of N rows, reads their results from the shared
// folder, and alone writes the results file. Results of tasks survive a crash of the caller or of a task. One thread at a
// time.
#pragma once

#include <omniORB4/CORBA.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "campaign/run/sweep.h"

namespace campaign {

struct SlurmOptions {
  std::string folder;                // that all machines share, with a path that all of them know
  std::size_t chunk = 10;            // rows of a task
  int tries = 3;                     // of a row whose task ends without its result
  std::vector<std::string> options;  // more words for sbatch
  std::vector<std::string> command;  // of a task, but for its number
};

Result<SweepResult> slurm_sweep(const Campaign& campaign, const SweepOptions& options, const SlurmOptions& slurm,
                                const std::function<void(const Progress&)>& show);

// "FOLDER:ATTEMPT:TASK", what a task is called with.
struct TaskPlace {
  std::string folder;
  int attempt = 0;
  std::size_t task = 0;
};
std::optional<TaskPlace> parse_task(const std::string& text);

// What a task does: runs its rows on this machine, in a folder of this machine, and tells what has come out. Rows that fail keep their
// files in options.kept. The error: why it could not.
Result<void> run_task(CORBA::ORB_ptr orb, const Campaign& campaign, const SweepOptions& options, const TaskPlace& place,
                      tools::Reporter& reporter);

}  // namespace campaign
