// Verbs of rtse that need libraries which rtse does not load (recordings, campaigns): separate programs execute them. One thread.
#pragma once

namespace base {
class Command;
}

namespace tools {

struct Chosen;

// When the command line names such a verb this process becomes its program, with the same words. When that is missing it says so and ends.
// Returns when the command line names none.
void become_program_of_verb(int argc, char** argv);

// For --help and completion.
void add_verbs_elsewhere(base::Command& app, Chosen& chosen);

}  // namespace tools
