// Verbs of rtse whose code needs what rtse itself does not load (shared memory, recordings): programs beside it carry them out. One thread.
#pragma once

namespace base {
class Command;
}

namespace editor {

struct Chosen;

// When the command line names such a verb this process becomes its program, with the same words. Returns when it names none, or when the
// program is missing, which run_program() then tells.
void become_program_of_verb(int argc, char** argv);

// For --help and completion.
void add_verbs_elsewhere(base::Command& app, Chosen& chosen);

}  // namespace editor
