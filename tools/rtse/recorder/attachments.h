// Attaches files to a recording, and the data that repeat its run. Any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "recording/mcap/mcap.h"

namespace recorder {

// The reason if NAME=FILE cannot be attached; empty: it can.
std::string attachment_problem(const std::string& text);
base::Result<void> attach_files(mcap::Writer& writer, const std::vector<std::string>& files);

struct RunFacts {
  std::uint32_t server_id = 0;
  bool is_simulated = false;       // the clock
  std::vector<std::string> notes;  // KEY=VALUE
};
// Attaches the data that repeat the run: the world, its seed, the programs.
void attach_run(mcap::Writer& writer, const RunFacts& facts);

}  // namespace recorder
