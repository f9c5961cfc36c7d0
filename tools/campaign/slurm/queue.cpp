#include "campaign/slurm/queue.h"

#include <unistd.h>

#include <chrono>

#include "base/child_process.h"
#include "base/text.h"
#include "campaign/run/campaign.h"

namespace campaign::slurm {
namespace {

using namespace std::chrono_literals;

constexpr auto limit = 60s;

// Also after an interrupt, which is when jobs are cancelled.
Result<std::string> said_by(std::vector<std::string> words) {
  auto started = base::ChildProcess::start({std::move(words), {}, ""});
  if (!started) return started.error();
  if (!started->wait(limit)) return Error{"program " + started->program() + ": did not end within " + std::to_string(limit.count()) + " s"};
  return base::output_of(*started);
}

}  // namespace

Result<void> check() {
  for (const char* program : {"sbatch", "squeue", "scancel"}) {
    if (!can_be_started(program))
      return Error{std::string("program ") + program + ": cannot be started; --engine slurm expects it in PATH (Debian: slurm-client)"};
  }
  return {};
}

Result<void> submit(const Submission& submission) {
  std::vector<std::string> words{"sbatch",
                                 "--parsable",
                                 "--no-requeue",
                                 "--job-name=" + submission.name,
                                 "--array=0-" + std::to_string(submission.count - 1),
                                 "--ntasks=1",
                                 "--cpus-per-task=" + std::to_string(submission.jobs),
                                 "--output=/dev/null"};
  words.insert(words.end(), submission.options.begin(), submission.options.end());
  words.insert(words.end(), {submission.script, std::to_string(submission.first)});
  const auto said = said_by(words);
  if (!said) return Error{"sbatch: " + said.error().message};
  return {};
}

Result<std::size_t> count(const std::string& name) {
  const auto said = said_by({"squeue", "--noheader", "--user=" + std::to_string(getuid()), "--name=" + name, "--format=%i"});
  if (!said) return Error{"squeue: " + said.error().message};
  return base::split_list(*said, '\n').size();
}

Result<void> cancel(const std::string& name) {
  const auto said = said_by({"scancel", "--quiet", "--user=" + std::to_string(getuid()), "--name=" + name});
  if (!said) return Error{"scancel: " + said.error().message};
  return {};
}

}  // namespace campaign::slurm
