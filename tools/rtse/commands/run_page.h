// `rtse run --page`: a run leaves one HTML page, which rtse-page writes from its recording. One thread at a time.
#pragma once

#include "rtse/console.h"
#include "run/run_options.h"
#include "run/run_system.h"

namespace editor {

// The run with a recording for its page: a temporary one beside the page, if the user wants none. Without --page the options as they are.
RunOptions recorded_for_page(const RunOptions& options);

// Writes the page of a run that recorded_for_page() made, and removes a temporary recording. Problems go to `console`. A run that left no
// recording leaves an older page as it is.
void write_page(Console& console, const RunOptions& given, const RunOptions& made, const RunResult& result);

// The command that repeats the run, as words of a shell.
std::string repeating_command(const RunOptions& options);

}  // namespace editor
