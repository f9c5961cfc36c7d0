// What the processes of a run have told that could depend on chance. One thread at a time.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace editor {

struct SavedSystem;

// One line for each, without doubles, from these log files.
std::vector<std::string> chances_in(const std::vector<std::string>& logs);

// Services between two components of one phase: whether the call comes before, in or after the tick of the component that is called, nobody
// decides. One line for each pair. `phases`: by instance, of those in lock step.
std::vector<std::string> services_of_one_phase(const SavedSystem& system, const std::map<std::string, std::int64_t>& phases);

}  // namespace editor
