// Writes a recording as one HTML file that shows the run in a browser without a server and without a network: the page of rtm-studio, with
// the data of the run in it (docs/run-page.md). The file is complete or it is not there, and an older one of its name stays until then.
// A recording that is still being written is followed: its samples are written into the page meanwhile. Memory: one part of the
// recording at a time, below 64 MiB with all else. One thread at a time.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "studio/client_message.h"

namespace page {

enum class RecordingState { growing, complete, abandoned };

struct PageOptions {
  std::string recording;                          // MCAP
  std::string second;                             // a second recording, shown as ghosts; empty: none
  std::string file;                               // the page
  std::string viewer;                             // run.html of the built page of rtm-studio
  double camera_rate = 1;                         // images of each camera per simulated second; 0: none
  std::uint64_t limit = 64ULL << 20U;             // of the page [bytes]
  studio::Json summary = studio::Json::object();  // of the run, see failure_marks.h; all optional
  // Returns when there is time for work on a recording that grows, or when it is complete, with the summary of the run. Null: it is
  // complete.
  std::function<RecordingState(studio::Json& summary)> follow;
};

struct PageReport {
  std::uint64_t bytes = 0;
  std::vector<std::string> left_out;  // a line for each kind of data that the page does not have, or has less often
};

// An error names the file that cannot be read or written.
base::Result<PageReport> write_run_page(const PageOptions& options);

}  // namespace page
