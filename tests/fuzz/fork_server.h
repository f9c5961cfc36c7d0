// Readers of files by fork instead of exec: a process that is like this one at its start, and forks a reader for each socket that it gets.
// A reader runs the code of rtm-asset-reader, with less memory (memory_budget.h). What ends it costs a fork, and no start of a program with
// its libraries. One thread at a time.
//
// The readers are children of this process, which waits for them: their parent, a child of the server, ends at once, and this process
// adopts what its descendants leave (PR_SET_CHILD_SUBREAPER). The server ends with this process.
#pragma once

#include <sys/types.h>

#include <cstddef>

#include "base/result.h"

namespace fuzz {

class ForkServer {
 public:
  // Before the first thread. `memory` [byte]: what a reader may take beyond what this process has now.
  explicit ForkServer(std::size_t memory);
  ~ForkServer();
  ForkServer(const ForkServer&) = delete;
  ForkServer& operator=(const ForkServer&) = delete;

  // A reader on this end of a socket.
  base::Result<pid_t> start(int socket);

 private:
  int control_ = -1;
  pid_t server_ = 0;
};

}  // namespace fuzz
