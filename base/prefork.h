// A prefork server: a program that runs its start-up once (libraries, and more), then forks on request. A forked process equals one that
// was started alone: own arguments, environment, output and process group. The client is rtse (run/prefork_server.h), over the socket on
// standard input.
//
// A request is one packet: words, an empty word, then the environment, each with a 0 at its end; and two descriptors: where the process
// writes, and a pipe that tells how it is: its process id, and when it has ended its status as wait() has it, both as int. When the socket
// is closed, or this process dies, what it has made is told to end.
#pragma once

#include <functional>

namespace base {

// Whether a program is asked to be one of these: by --warm, its only word. For rtse alone, so no --help tells of it.
bool is_prefork_server(int argc, char** argv);

// Of one thread; what was done before is part of every start. Returns the exit code: of this process, or in a new one that of `program`.
int make_processes(const std::function<int(int, char**)>& program);

}  // namespace base
