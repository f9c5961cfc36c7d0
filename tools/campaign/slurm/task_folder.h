// The folder that the caller of a sweep shares with its tasks on other machines. Every file has one writer, and no file is locked, so any
// network file system is sufficient. One thread at a time.
//
//   name            of the jobs in the queue, chosen once
//   key             of the campaign: tasks with other programs, worlds or plans exit
//   N.todo          a line for each task of attempt N: its rows, as "1..10 12"
//   N.sh            the script that all tasks of attempt N run
//   parts/N-T       what task T of attempt N has found, one line of JSON for each row
//   logs/N-T        its terminal output, if there is any
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/result.h"
#include "campaign/slurm/outcome_line.h"

namespace campaign {

using base::Error;
using base::Result;

using RowNumbers = std::vector<std::size_t>;

class TaskFolder {
 public:
  // `folder` as a path that every machine knows.
  explicit TaskFolder(std::string folder) : folder_(std::move(folder)) {}

  // Makes it for a campaign, or goes on with one of the same campaign. Of another: is_other() says so, and nothing is changed.
  Result<void> open(const std::string& base_key);
  bool is_other() const { return is_other_; }
  // Takes everything away.
  void remove() const;

  const std::string& path() const { return folder_; }
  const std::string& name() const { return name_; }
  // Those that were begun, by earlier calls too.
  int attempts() const { return attempts_; }
  // Begins one; returns its number.
  Result<int> begin_attempt(const std::vector<RowNumbers>& tasks, const std::string& script);
  std::string script(int attempt) const { return folder_ + "/" + std::to_string(attempt) + ".sh"; }
  std::string log(int attempt, std::size_t task) const { return numbered("logs", attempt, task); }

  // What tasks have written since the last call, of all attempts.
  std::vector<OutcomeLine> news();

  // For a task.
  Result<void> check_key(const std::string& base_key) const;
  Result<RowNumbers> rows_of(int attempt, std::size_t task) const;
  std::string part(int attempt, std::size_t task) const { return numbered("parts", attempt, task); }

 private:
  std::string numbered(const std::string& kind, int attempt, std::size_t task) const {
    return folder_ + "/" + kind + "/" + std::to_string(attempt) + "-" + std::to_string(task);
  }
  void list_parts();

  std::string folder_, name_;
  bool is_other_ = false;
  int attempts_ = 0;
  std::map<std::string, std::uintmax_t> parts_;  // file -> octets read
};

// "1..3 7".
std::string to_text(const RowNumbers& rows);

}  // namespace campaign
