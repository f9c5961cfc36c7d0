// A child process that never outlives its owner: the destructor ends it, and the kernel kills it if this process is killed. Processes that
// it started itself end with it. One thread at a time.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "base/result.h"

namespace base {

inline constexpr const char* own_output = "/dev/stdout";

struct ProgramCall {
  std::vector<std::string> words;                  // program and arguments
  std::map<std::string, std::string> environment;  // added to ours
  std::string output{};        // file for its standard output and error; empty: they are collected, see said(); own_output: ours
  std::string folder{};        // where it starts; empty: in ours
  bool ends_as_group = false;  // what it has started is told to end with it
  int input = -1;              // descriptor of its standard input; -1: it has none
};

enum class Ending { ended, timed_out, interrupted };

class ChildProcess {
 public:
  static Result<ChildProcess> start(const ProgramCall& call);
  // One that another process has made for us. `watched`: a pipe that its status comes by, ours from now on; `collected`: a file with what
  // it writes, ours too, or -1.
  static ChildProcess made_elsewhere(pid_t pid, int watched, int collected, std::string program, bool ends_as_group);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  ~ChildProcess();  // SIGTERM, and SIGKILL after five seconds

  pid_t pid() const { return started_; }
  bool is_running();
  // Of an ended program: its exit code, or 128 + signal.
  int exit_code() const { return exit_code_; }
  // Of an ended program: "ended with exit code 3", "was killed by signal 11 (Segmentation fault)".
  std::string how_it_ended() const;
  // False when it still runs after the time.
  bool wait(std::chrono::milliseconds limit);
  // The same, but an interrupt ends the wait; see interrupt.h.
  Ending wait_or_interrupt(std::chrono::milliseconds limit);
  void terminate();
  // What it has written so far, if it has no output file.
  std::string said() const;
  const std::string& program() const { return program_; }

 private:
  ChildProcess(pid_t pid, int collected, std::string program, bool ends_as_group)
      : pid_(pid), started_(pid), ends_as_group_(ends_as_group), collected_(collected), program_(std::move(program)) {}
  bool reap();
  bool reap_watched();
  void wait_for_event(int handle, std::chrono::milliseconds limit) const;
  void end();
  pid_t pid_ = -1;  // -1: it has ended
  pid_t started_ = -1;
  bool ends_as_group_ = false;
  bool is_told_ = false;  // to end: programs may take a second time for impatience
  int watched_ = -1;      // of one that another process has made, see made_elsewhere()
  int collected_ = -1;
  int exit_code_ = -1;
  std::string program_;
};

// Runs a program to its end, at most `limit`, and returns what it wrote. An error when it fails: the last line it wrote.
Result<std::string> output_of(const ProgramCall& call, std::chrono::milliseconds limit);
// The same of one that was started by the caller.
Result<std::string> output_of(ChildProcess& started, std::chrono::milliseconds limit);
// The same of one that has ended.
Result<std::string> output_of(const ChildProcess& ended);

// A command line of the user's for a run: sh finds the programs beside this one before those of the path, and in its environment the run's
// RTMSIM_RECORD, RTMSIM_SERVER_ID and RTCTREE_NAMESERVERS.
ProgramCall shell_call(const std::string& line, const std::string& record, const std::string& server_id, const std::string& naming);

// One of our own programs: beside this one, else from the path.
std::string own_program(const std::string& name);

}  // namespace base
