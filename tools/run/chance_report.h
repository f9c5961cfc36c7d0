// Collects the nondeterministic events that the processes of a run reported. One thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace tools {

struct ComponentView;
struct RunOptions;
struct SavedSystem;
class Simulator;

// A run that is to be strict, or in a CI job.
bool tells_of_chance(const RunOptions& options);

// Who takes part in the lock step, by instance: when they are called.
struct PlaceInTime {
  std::int64_t phase = 0;
  std::chrono::nanoseconds period{0};  // between two calls: at least a step
};
using PlacesInTime = std::map<std::string, PlaceInTime>;
PlacesInTime places_in_time(Simulator& simulator);

// A line that ends in a time with the number of the component's tick behind it: "port A:out was written by a thread that no tick runs at
// 0.06 s, in tick 6".
std::string with_tick(const std::string& what, const PlacesInTime& places);

// One line for each, without doubles, from these log files.
std::vector<std::string> chances_in(const std::vector<std::string>& logs, const PlacesInTime& places);

// Services between two components of one phase: whether the call comes before, in or after the tick of the component that is called, nobody
// decides. One line for each pair.
std::vector<std::string> services_of_one_phase(const SavedSystem& system, const PlacesInTime& places);

// The full names of its ports that provide a service.
std::set<std::string> providers_of(const ComponentView& component);

// Two components of one phase that call services of a third: whose call comes first, nobody decides. One line for each pair. `providers`:
// the full names of all ports that provide a service.
std::vector<std::string> callers_of_one_phase(const SavedSystem& system, const PlacesInTime& places,
                                              const std::set<std::string>& providers);

}  // namespace tools
