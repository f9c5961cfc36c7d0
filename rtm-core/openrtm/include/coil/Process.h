// Starting other programs. Any thread.
#pragma once

#include <string>
#include <vector>

namespace coil {

// Hands a command line to the shell and does not wait for it. 0, or -1 if no process could be made.
int launch_shell(const std::string& command);
// Runs a command line in the shell, waits for its end and appends the lines it writes to `out`. 0, or -1 if it can't be run or does not
// exit with 0.
int create_process(const std::string& command, std::vector<std::string>& out);
// Goes on in the background without a terminal; see daemon(3).
int daemonize();

}  // namespace coil
