// A signal of a recording over time, for plots. Opens the file itself; any thread.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "studio/client_message.h"
#include "studio/recording_facts.h"

namespace studio {

struct SeriesOrder {
  std::string topic;
  std::vector<std::string> members;
  std::chrono::nanoseconds from{0}, to{0};
  std::size_t points = 0;  // maximum number of samples returned, evenly in time
};

// {"t":[s,...], "v":[[m1,m2,...],...], "until":s, "left_out":N}: `until` is where it stopped, since it takes no more than ten seconds;
// `left_out` counts the samples that are not given.
base::Result<Json> recorded_series(const RecordingFacts& facts, const SeriesOrder& order);

}  // namespace studio
