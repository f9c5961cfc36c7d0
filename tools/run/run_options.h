// What a user asks of `rtse run`: the options that are about repeatability, and whether what all of them ask for can be done. One thread at
// a time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/result.h"

namespace base {
class Command;
}

namespace editor {

struct ComponentProperty;
struct RunOptions;
struct SavedSystem;

// --hash-log, --twice, --strict. `options` must live as long as the command.
void add_repeatability_options(base::Command& run, RunOptions& options);
// --record, --last.
void add_recording_options(base::Command& run, RunOptions& options);

// Rates, folders and properties, held against the system. The properties.
base::Result<std::vector<ComponentProperty>> read_wishes(const RunOptions& options, const SavedSystem& system);

// What makes a run again, beside the profile and the world.
std::vector<std::pair<std::string, std::string>> notes_on(const RunOptions& options, const std::vector<std::string>& others);

}  // namespace editor
