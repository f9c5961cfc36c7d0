// The campaign verbs of rtse. Each adds its part of the command line; see rtse/command.h.
#pragma once

namespace base {
class Command;
}
namespace tools {
struct Chosen;
}

namespace campaign {

void add_sweep(base::Command& app, tools::Chosen& chosen);
void add_hunt(base::Command& app, tools::Chosen& chosen);
void add_results(base::Command& app, tools::Chosen& chosen);

}  // namespace campaign
