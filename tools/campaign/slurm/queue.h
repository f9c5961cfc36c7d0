// The queue of Slurm, by the commands sbatch, squeue, scancel. Jobs are identified by name, so a restarted caller finds them. Every call
// has a timeout. One thread at a time.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"

namespace campaign::slurm {

using base::Error;
using base::Result;

// What one array may have by Slurm's usual MaxArraySize, and a queue by its usual MaxJobCount.
inline constexpr std::size_t max_in_array = 1000, max_tasks = 10'000;

// The commands are there. The error names one that is not.
Result<void> check();

struct Submission {
  std::string name, script;
  std::size_t first = 0, count = 0;  // tasks of this array; the script gets `first` as its argument, and SLURM_ARRAY_TASK_ID from 0
  int jobs = 1;                      // processors of a task
  std::vector<std::string> options;  // more words for sbatch
};
Result<void> submit(const Submission& submission);
// How many entries the queue has of our jobs of that name: pending, running, or ending.
Result<std::size_t> count(const std::string& name);
Result<void> cancel(const std::string& name);

}  // namespace campaign::slurm
