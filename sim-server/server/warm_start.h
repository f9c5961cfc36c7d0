// A server that does what every server does first (libraries, the specification of SDFormat: more than half of a start), and then makes
// servers by forking whenever it is asked to. Each is as one that was started alone: its own words, environment, output and process group,
// nothing of a world, no thread, no file. Who asks is rtse (system-editor/run/warm_program.h), over the socket that is standard input.
//
// A request is one packet: words, an empty word, then the environment, each with a 0 at its end; and two descriptors: where the server
// writes, and a pipe that tells how it is: its process id, and when it has ended its status as wait() has it, both as int. When the socket
// is closed, or this process dies, its servers are told to end.
#pragma once

#include <functional>

namespace sim {

// Of one thread. Returns the exit code: of this process, or in a new one that of `server`.
int make_servers(const std::function<int(int, char**)>& server);

}  // namespace sim
