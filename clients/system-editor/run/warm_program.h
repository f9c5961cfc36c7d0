// A sim-server that has done the first half of its start and makes others by forking: for who starts many, one after the other. What it
// makes runs as if it had been started alone, to the bit. See sim-server/server/warm_start.h. Any thread.
#pragma once

#include <memory>
#include <optional>

#include "run/child_process.h"

namespace editor {

class WarmProgram {
 public:
  // To be called by a thread that outlives it: the kernel ends the program when that thread ends. Nothing when it cannot be started, which
  // is no loss but of time.
  static std::optional<WarmProgram> start_simulator();
  WarmProgram(WarmProgram&&) noexcept = default;
  ~WarmProgram();

  // As ChildProcess::start(call), whose first word is the program; by that when it cannot be made here.
  base::Result<ChildProcess> start(const ProgramCall& call) const;

 private:
  WarmProgram(ChildProcess program, int line) : program_(std::make_unique<ChildProcess>(std::move(program))), line_(line) {}
  std::unique_ptr<ChildProcess> program_;
  int line_;
};

}  // namespace editor
