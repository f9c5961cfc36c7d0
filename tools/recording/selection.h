// The samples of a recording that a command processes: channels and time range. Values; one thread.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "recording/mcap/mcap.h"
#include "system/editor.h"

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

// Nothing, and the editor has said why, when the file can't be read. Damage is told on stderr.
std::optional<mcap::Reader> open(editor::Editor& editor, const std::string& file);

// The components of other makers in the run, whose samples have stamps of their own clocks (`tm`), which differ in each run.
std::vector<std::string> others_of(mcap::Reader& reader);

// Calls `take` with each message of the selection until it says false; broken chunks are told and passed over.
void for_each(editor::Editor& editor, mcap::Reader& reader, const Selection& selection,
              const std::function<bool(const mcap::Message&)>& take);

}  // namespace recorder
