// A program that runs beside us and never outlives us: it is told to end when its owner goes, and killed by the kernel when we are killed.
// One thread at a time.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "base/result.h"

namespace editor {

struct ProgramCall {
  std::vector<std::string> words;                  // program and arguments
  std::map<std::string, std::string> environment;  // added to ours
  std::string output;                              // file for its standard output and error
};

class ChildProcess {
 public:
  static base::Result<ChildProcess> start(const ProgramCall& call);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  ~ChildProcess();  // SIGTERM, and SIGKILL after five seconds

  bool is_running();
  // Of an ended program: its exit code, or 128 + signal.
  int exit_code() const { return exit_code_; }
  // False when it still runs after the time.
  bool wait(std::chrono::milliseconds limit);
  void terminate();
  const std::string& program() const { return program_; }

 private:
  ChildProcess(pid_t pid, std::string program) : pid_(pid), program_(std::move(program)) {}
  void end();
  pid_t pid_ = -1;
  int exit_code_ = -1;
  std::string program_;
};

// Runs a program to its end, at most `limit`, and returns what it wrote to standard output. An error when it fails: the last line it wrote.
base::Result<std::string> output_of(const ProgramCall& call, std::chrono::milliseconds limit);

// One of our own programs: beside this one, else from the path.
std::string own_program(const std::string& name);

}  // namespace editor
