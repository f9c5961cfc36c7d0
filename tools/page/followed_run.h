// The run whose recording is followed. Its end is read from standard input: the summary when the recording is complete, nothing if the run
// was abandoned. Until then the work on the page gets only a share of one processor, so that it does not slow the run down, or all of one
// if two are idle. One thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "page/run_page.h"

namespace page {

class FollowedRun {
 public:
  // `share`: of the time of one processor.
  explicit FollowedRun(double share);
  // Returns when there is time for some more work, or at the end of the run.
  RecordingState wait(studio::Json& summary);

 private:
  using Clock = std::chrono::steady_clock;

  RecordingState end(studio::Json& summary) const;
  bool may_work();
  bool are_processors_idle();

  const double share_;
  const Clock::time_point began_ = Clock::now();
  Clock::time_point looked_ = began_;
  std::uint64_t idle_ticks_ = 0;  // of all processors, at that time
  std::string text_;
};

}  // namespace page
