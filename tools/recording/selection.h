// The samples of a recording that a command processes: channels and time range. Values; one thread.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.h"
#include "recording/mcap/mcap.h"
#include "system/reporter.h"

namespace recorder {

struct Selection {
  std::string file;
  std::vector<std::string> topics;  // patterns; none: all
  double from_s = 0;
  double to_s = 0;  // 0: the end
  int count = 0;    // 0: all
};

// [s]
inline double seconds(mcap::Time time) { return static_cast<double>(time.count()) / 1e9; }

// Fails for a pattern that no channel fits.
base::Result<mcap::Query> query_of(const mcap::Reader& reader, const Selection& selection);

// Fails when the file cannot be read. Damage that can be read around is a warning.
base::Result<mcap::Reader> open(const std::string& file, tools::Reporter& reporter);

// The components of other makers in the run, whose samples have stamps of their own clocks (`tm`), which differ in each run.
std::vector<std::string> others_of(mcap::Reader& reader);

// Calls `take` with each message of the selection until it returns false. Broken chunks are skipped and returned, the first few in detail.
std::vector<base::Error> for_each(mcap::Reader& reader, const Selection& selection, const std::function<bool(const mcap::Message&)>& take);

}  // namespace recorder
