// The verbs of rtse that are about campaigns. Each adds its part of the command line; see command.h of the system editor.
#pragma once

namespace CLI {
class App;
}
namespace editor {
struct Chosen;
}

namespace campaign {

void add_sweep(CLI::App& app, editor::Chosen& chosen);
void add_hunt(CLI::App& app, editor::Chosen& chosen);
void add_results(CLI::App& app, editor::Chosen& chosen);

}  // namespace campaign
