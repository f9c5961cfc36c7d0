// Options of `rtse run` that are about repeatability. One thread at a time.
#pragma once

namespace CLI {
class App;
}

namespace editor {

struct RunOptions;

// --hash-log, --twice, --strict. `options` must live as long as the command.
void add_repeatability_options(CLI::App& run, RunOptions& options);

}  // namespace editor
