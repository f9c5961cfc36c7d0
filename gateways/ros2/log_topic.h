// The lines that this process logs, as messages of /rosout; they go to standard error as before. Lines may come from any thread, the rest
// belongs to one at a time.
#pragma once

#include <memory>

#include "dds/participant.h"

namespace ros2 {

class LogTopic {
 public:
  // One at a time in a process.
  LogTopic();
  ~LogTopic();
  LogTopic(const LogTopic&) = delete;
  LogTopic& operator=(const LogTopic&) = delete;

  // Sends the lines since the last call; those beyond 1000 are left out.
  void send(Writer& writer);

 private:
  struct Lines;
  std::shared_ptr<Lines> lines_;
};

}  // namespace ros2
