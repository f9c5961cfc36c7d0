// The recording verbs of rtse. Each adds its part of the command line; see rtse/command.h.
#pragma once

namespace base {
class Command;
}
namespace tools {
struct Chosen;
}

namespace recorder {

void add_record(base::Command& app, tools::Chosen& chosen);
void add_play(base::Command& app, tools::Chosen& chosen);
void add_replay(base::Command& app, tools::Chosen& chosen);
void add_run_like(base::Command& app, tools::Chosen& chosen);
void add_goto(base::Command& app, tools::Chosen& chosen);
void add_page(base::Command& app, tools::Chosen& chosen);
void add_recording(base::Command& app, tools::Chosen& chosen);  // info, ls, cat, export, compare, repair

}  // namespace recorder
