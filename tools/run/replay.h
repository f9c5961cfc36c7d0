// Runs one component with its recorded inputs: each input is sent in the tick in which it was recorded, and the outputs are compared. One
// thread at a time; it has a thread of its own, which takes part in the lock step.
//
// Inputs of tick t from components of an earlier phase are sent before the component's tick t, all others after it. So the component reads
// them in the same tick as in the recorded run.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recording/mcap/mcap.h"
#include "recording/sample_difference.h"
#include "run/recorded_life.h"
#include "run/run_system.h"
#include "system/session.h"

namespace recorder {

// A recorded channel and the InPort that gets it.
struct ReplayLink {
  std::string topic;
  std::string port;  // of the component
  tools::Properties properties;
};

struct ReplayOptions {
  std::string file;
  std::string component;  // instance name
  std::vector<ReplayLink> links{};
  bool compares = false;
  DifferenceOptions tolerated{};
  RecordedLife life{};
};

// An OutPort of the component against its channel.
struct ReplayedOutput {
  std::string topic;
  std::uint64_t samples = 0;    // that it sent
  std::uint64_t recorded = 0;   // that it should have sent
  std::uint64_t different = 0;  // of those, wrong or missing
  std::string first;            // "tick 12 (1.200 s): data.vx: 0.5 and 0.4"
  double first_s = 0;           // its time, of the recording
};

struct ReplayResult {
  std::uint64_t ticks = 0;
  std::uint64_t sent = 0;     // inputs
  std::uint64_t changes = 0;  // of configuration and state
  double simulated_s = 0;
  double wall_s = 0;  // of the ticks alone
  std::vector<ReplayedOutput> outputs;
};

// `system` holds the component alone, wired to nothing, before its first step.
base::Result<ReplayResult> replay(CORBA::ORB_ptr orb, tools::RunningSystem& system, const ReplayOptions& options);

}  // namespace recorder
