// Processes that a signal or a debugger has stopped: they exist, and answer nothing. Any thread.
#pragma once

#include <sys/types.h>

#include <optional>

namespace tools {

bool is_stopped(pid_t pid);
// The process itself, or one of the process group that it leads; nothing when none is stopped.
std::optional<pid_t> stopped_process(pid_t pid);

}  // namespace tools
