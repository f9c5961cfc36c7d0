// What the processes of a run have told that could depend on chance. One thread at a time.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace editor {

struct ComponentView;
struct SavedSystem;

// One line for each, without doubles, from these log files.
std::vector<std::string> chances_in(const std::vector<std::string>& logs);

// Services between two components of one phase: whether the call comes before, in or after the tick of the component that is called, nobody
// decides. One line for each pair. `phases`: by instance, of those in lock step.
std::vector<std::string> services_of_one_phase(const SavedSystem& system, const std::map<std::string, std::int64_t>& phases);

// The full names of its ports that provide a service.
std::set<std::string> providers_of(const ComponentView& component);

// Two components of one phase that call services of a third: whose call comes first, nobody decides. One line for each pair. `providers`:
// the full names of all ports that provide a service.
std::vector<std::string> callers_of_one_phase(const SavedSystem& system, const std::map<std::string, std::int64_t>& phases,
                                              const std::set<std::string>& providers);

}  // namespace editor
