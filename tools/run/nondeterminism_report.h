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

// True for a strict run, and in a CI job.
bool reports_nondeterminism(const RunOptions& options);

// When each lock-step participant is called, by instance.
struct ScheduleSlot {
  std::int64_t phase = 0;
  std::chrono::nanoseconds period{0};  // between two calls: at least a step
};
using Schedule = std::map<std::string, ScheduleSlot>;
Schedule read_schedule(Simulator& simulator);

// A line that ends in a time with the number of the component's tick behind it: "port A:out was written by a thread that no tick runs at
// 0.06 s, in tick 6".
std::string with_tick(const std::string& what, const Schedule& places);

// The events in these log files, one line each, without duplicates.
std::vector<std::string> nondeterministic_events_in(const std::vector<std::string>& logs, const Schedule& places);

// Services between two components of one phase: the call can come before, in or after the tick of the called component. One line for each
// pair.
std::vector<std::string> services_of_one_phase(const SavedSystem& system, const Schedule& places);

// The full names of its ports that provide a service.
std::set<std::string> providers_of(const ComponentView& component);

// Pairs of components of one phase that call services of a third one: the order of their calls is not defined. One line for each pair.
// `providers`: the full names of all ports that provide a service.
std::vector<std::string> callers_of_one_phase(const SavedSystem& system, const Schedule& places, const std::set<std::string>& providers);

}  // namespace tools
