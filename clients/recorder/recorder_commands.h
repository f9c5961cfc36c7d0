// The verbs of rtse that are about recordings. Each adds its part of the command line; see command.h of the system editor.
#pragma once

namespace CLI {
class App;
}
namespace editor {
struct Chosen;
}

namespace recorder {

void add_record(CLI::App& app, editor::Chosen& chosen);
void add_play(CLI::App& app, editor::Chosen& chosen);
void add_replay(CLI::App& app, editor::Chosen& chosen);
void add_run_like(CLI::App& app, editor::Chosen& chosen);
void add_goto(CLI::App& app, editor::Chosen& chosen);
void add_recording(CLI::App& app, editor::Chosen& chosen);  // info, ls, cat, export, compare, repair

}  // namespace recorder
