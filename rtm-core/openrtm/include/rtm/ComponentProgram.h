// What the program of one component (<Name>Comp) answers without running: --help, --version, --man, --completion bash|zsh. Any thread.
#pragma once

#include <optional>
#include <string>

namespace RTC {

// Prints what the command line asks for; the exit code when that is all that the program is to do. `component` is its type.
std::optional<int> answerForItself(int argc, char** argv, const std::string& component, const std::string& version);

}  // namespace RTC
