// The line between a run and its recorder: messages over a pair of sockets, one packet each. Each side is used by one thread at a time.
//
//   run                      recorder
//   (starts it)         ->
//                       <-   recording     every port is connected
//   look_again          ->                 components were started again; any number of times
//                       <-   looked        their ports are connected again
//   stop                ->                 take nothing more; write what waits
//                       <-   stopped       with a hash log to come: everything else is written
//   hashes_ready        ->                 the hash log is complete
//                                          (the recorder exits)
//
// A run that has exited closes its end, which is a stop for the recorder. A recorder that has exited closes its own: the run reads how it
// ended from its process. No call waits longer than its timeout.
#pragma once

#include <chrono>
#include <optional>
#include <utility>

#include "base/file_handle.h"
#include "base/result.h"

namespace recorder {

enum class RecorderMessage : unsigned char { recording = 1, look_again, looked, stop, stopped, hashes_ready };

class RecorderLine {
 public:
  // Both ends; the second is for the other process.
  static base::Result<std::pair<RecorderLine, base::FileHandle>> make();
  explicit RecorderLine(base::FileHandle end) : end_(std::move(end)) {}

  // An Error: the other side has closed its end.
  base::Result<void> send(RecorderMessage message);
  // Nothing: no message within the timeout. An Error: the other side has closed its end, or sends what is no message.
  base::Result<std::optional<RecorderMessage>> receive(std::chrono::milliseconds timeout);
  // Readable when there is a message, or the other end is closed.
  int descriptor() const { return end_.get(); }

 private:
  base::FileHandle end_;
};

}  // namespace recorder
