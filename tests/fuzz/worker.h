// Does jobs one after the other in a child process, and continues with a new child after a job that ended it. For campaigns with a
// sanitizer: a job costs no process, and of a child that ended the report of the sanitizer says in which library. One thread at a time.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace fuzz {

// How a job ended its child.
struct Ending {
  std::string how;           // signal or error, and the first frame outside of the runtime libraries: "SEGV in libassimp.so.5+0x4f1a20"
  std::string report;        // of the sanitizer; empty: none
  bool is_late = false;      // the job was not done in time
  bool is_own_code = false;  // not in a library that parses files
};

struct Progress {
  long done = 0;  // jobs
  long good = 0;  // of them, those that returned true
};

struct Work {
  long count = 0;
  std::size_t memory = 0;                             // [byte] of a child (memory_budget.h)
  std::function<void()> prepare;                      // in each child, before its first job
  std::function<bool(long)> job;                      // in a child; one that takes more than 60 s ends it
  std::function<void(long, const Ending&)> ended;     // here, for each job that ended a child
  std::function<void(const Progress&)> has_progress;  // here, after each 5000 jobs and at the end
};

// Does job(0) to job(count - 1).
void run_in_children(const Work& work);

// The first frame of a sanitizer's report that is in no runtime library (C, C++, sanitizer) and is no operator new or delete, as
// MODULE+OFFSET; empty: there is none.
std::string first_frame(const std::string& report);

}  // namespace fuzz
