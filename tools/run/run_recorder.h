// The recording of a run: the program rtse-recorder at all OutPorts of the system, from before the first step to the end. One thread at a
// time.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/child_process.h"
#include "recording/recorder_line.h"
#include "run/run_files.h"

namespace tools {

struct RecorderCall {
  std::string server;                                      // of the naming service
  std::string simulator;                                   // its id
  std::string system;                                      // the profile as it is for this run
  std::string file;                                        // to write
  double last_s = 0;                                       // only so much before the end; 0: all
  std::string script;                                      // a file, see RunScript::written(); empty: none
  std::string hashes;                                      // the run's hash log, see finish(); empty: none
  std::vector<std::pair<std::string, std::string>> notes;  // how the run was made
};

class RunRecorder {
 public:
  // Waits until `ready`, or says of `what` why it never will be.
  using Wait = std::function<base::Result<void>(const std::string& what, const std::function<bool()>& ready)>;

  explicit RunRecorder(const Workplace& place) : place_(place) {}

  // Returns when every port is connected to it.
  base::Result<void> start(const RecorderCall& call, const Wait& wait_until);
  // At the ports of components that are there again, too; when it was started.
  base::Result<void> look_again(const Wait& wait_until);
  // It takes nothing more. The file is whole then, unless there is a hash log to come. Nothing happens when it was not started, here and
  // in finish().
  void end();
  // Once the hash log is there. An error when the file is not whole.
  base::Result<void> finish();

 private:
  std::string said() const;
  bool has_told(recorder::RecorderMessage message, std::chrono::milliseconds timeout);
  bool tell(recorder::RecorderMessage message);

  const Workplace& place_;
  std::optional<base::ChildProcess> process_;
  std::optional<recorder::RecorderLine> line_;
  std::string log_;
  std::string file_;
  bool is_ring_ = false;
  bool takes_hashes_ = false;
  bool has_begun_ = false, has_stopped_ = false;
};

}  // namespace tools
