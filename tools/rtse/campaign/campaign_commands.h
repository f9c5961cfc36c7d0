// The campaign verbs of rtse. Each adds its part of the command line; see rtse/command.h.
#pragma once

namespace base {
class Command;
}
namespace editor {
struct Chosen;
}

namespace campaign {

void add_sweep(base::Command& app, editor::Chosen& chosen);
void add_hunt(base::Command& app, editor::Chosen& chosen);
void add_results(base::Command& app, editor::Chosen& chosen);

}  // namespace campaign
