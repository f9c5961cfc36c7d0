// The life of rtm-asset-reader (reader/protocol.h). Whatever a file does to this process, the simulator continues: limits are set before
// the first file, and its end is the end of that file alone. For a process that does nothing else.
#pragma once

namespace sim {

// Answers what comes on descriptor 3 until its other end is closed. The exit status.
int serve_assets();

}  // namespace sim
