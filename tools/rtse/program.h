// The main function of rtse, and of the programs that contain some of its verbs: common options, the ORB, errors, the exit code. Called
// once, from main.
#pragma once

#include <vector>

namespace base {
class Command;
}

namespace tools {

struct Chosen;

using AddCommand = void (*)(base::Command& app, Chosen& chosen);

// The exit code: 0 done, 1 failed, 2 wrong command line.
int run_program(const std::vector<AddCommand>& commands, int argc, char** argv);

}  // namespace tools
