// Runs a system twice and compares the two runs. One thread at a time.
#pragma once

#include "run/run_system.h"

namespace tools {

// The result of the first run, with a verdict on whether the second was the same in every tick. The first run keeps its hash log, picture
// and recording as the options say; the log of the second is FILE.2 when there is a hash log FILE.
RunResult run_twice(CORBA::ORB_ptr orb, const RunOptions& options, Reporter& reporter);

}  // namespace tools
