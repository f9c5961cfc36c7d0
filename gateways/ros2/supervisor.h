// Runs the gateway in a child process, and starts it again when a signal has ended it: packets of the network are read by a library that
// may crash. To be called before any thread is started, with SIGINT and SIGTERM blocked; they are passed on to the child.
#pragma once

#include <functional>

namespace ros2 {

// The exit code of the last child. `run` is called in each child.
int supervise(const std::function<int()>& run);

}  // namespace ros2
