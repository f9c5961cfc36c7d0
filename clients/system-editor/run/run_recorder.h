// The recording of a run: the program rtse-recorder at all OutPorts of the system, from before the first step to the end. One thread at a
// time.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "run/child_process.h"
#include "run/run_files.h"

namespace editor {

struct RecorderCall {
  std::string server;                                      // of the naming service
  std::string simulator;                                   // its id
  std::string system;                                      // the profile as it is for this run
  std::string file;                                        // to write
  std::vector<std::pair<std::string, std::string>> notes;  // how the run was made
};

class RunRecorder {
 public:
  // Waits until `ready`, or says of `what` why it never will be.
  using Wait = std::function<base::Result<void>(const std::string& what, const std::function<bool()>& ready)>;

  explicit RunRecorder(const Workplace& place) : place_(place) {}

  // Returns when every port is connected to it.
  base::Result<void> start(const RecorderCall& call, const Wait& wait_until);
  // Ends it, so that the file is whole; an error when it is not. Nothing happens when it was not started.
  base::Result<void> end();

 private:
  std::string said() const;

  const Workplace& place_;
  std::optional<ChildProcess> process_;
  std::string log_;
};

}  // namespace editor
