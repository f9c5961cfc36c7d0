// `rtse run`, also with the options of a recorded run. One thread at a time.
#pragma once

#include <functional>
#include <string>

#include "base/result.h"
#include "run/run_options.h"

namespace base {
class Command;
}

namespace tools {

class Console;
struct Chosen;

// The options of the run of a recording, whose files exist as long as this function.
// Warns of what the recording lacks.
using ReadLike = std::function<base::Result<RunOptions>(Console& console, const std::string& recording)>;

// `run --like RECORDING`, and all options of `run` in place of the recorded ones.
// `check` returns the reason if a file is not a recording, as a whole line; empty: it is one.
void add_run_like(base::Command& app, Chosen& chosen, ReadLike read_like, std::function<std::string(const std::string&)> check);

}  // namespace tools
