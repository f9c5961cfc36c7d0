// The program of one component (<Name>Comp). Light to include: every such program is compiled from a few lines.
#pragma once

#include <optional>
#include <string>

namespace RTC {

class Manager;

// What the program answers without running: --help, --version, --man, --completion bash|zsh. Any thread. Prints what the command line asks
// for; the exit code when that is all that the program is to do. `component` is its type.
std::optional<int> answerForItself(int argc, char** argv, const std::string& component, const std::string& version);

// All of main(): answers for itself, or makes one component of the type that `init` registers, and runs until Ctrl+C or SIGTERM. The exit
// code; 1 and a line on standard error when the component could not be created. Once in a process, from main().
int runComponentProgram(int argc, char** argv, const std::string& component, const std::string& version, void (*init)(Manager*));

}  // namespace RTC
