// Prefork servers: programs that have done the first part of their start and fork for each further process, for many runs one after the
// other. A forked process runs as if it had been started alone, bit-identical. See base/prefork.h. Any thread.
#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/child_process.h"
#include "system/reporter.h"

namespace tools {

class PreforkServer {
 public:
  // One of our own programs. To be called by a thread that outlives it: the kernel ends the program when that thread ends. Nothing when it
  // cannot be started, which is no loss but of time.
  // `reporter` must live as long.
  static std::optional<PreforkServer> start(const std::string& name, std::map<std::string, std::string> environment, Reporter& reporter);
  PreforkServer(PreforkServer&&) noexcept = default;
  ~PreforkServer();

  // As ChildProcess::start(call), whose first word is the program; by that when it cannot be made here. A program that is asked and says
  // nothing for five seconds is not asked again.
  base::Result<base::ChildProcess> make(const base::ProgramCall& call) const;
  // False when it has ended; the kernel has told what it made to end, too, before any of that has ended.
  bool is_there() const;
  const std::string& path() const { return path_; }

 private:
  PreforkServer(base::ChildProcess program, std::string path, int line, Reporter& reporter)
      : program_(std::make_unique<base::ChildProcess>(std::move(program))), path_(std::move(path)), line_(line), reporter_(&reporter) {}
  std::unique_ptr<base::ChildProcess> program_;
  std::string path_;
  std::unique_ptr<std::atomic<bool>> is_silent_ = std::make_unique<std::atomic<bool>>(false);
  int line_;
  Reporter* reporter_;
};

// The prefork servers of the programs that every run starts: the simulator and component hosts.
class PreforkServers {
 public:
  explicit PreforkServers(Reporter& reporter);  // must live as long
  // Like ChildProcess::start(call), by the prefork server of its program.
  base::Result<base::ChildProcess> make(const base::ProgramCall& call) const;
  std::size_t count() const;  // of those that are there

 private:
  std::vector<PreforkServer> programs_;
};

// Uses a prefork server if there is one for the program.
base::Result<base::ChildProcess> start_program(const PreforkServers* prefork, const base::ProgramCall& call);

}  // namespace tools
