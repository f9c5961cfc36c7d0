// Reports (base/nondeterminism.h) calls from other processes that change something while lock-step time passes: their time is
// nondeterministic. Calls while time is paused (before the first step, at a stop of a run script, after the last step) are not
// reported. Reading calls, samples and callbacks of contexts in other processes are not reported either, nor services called by a tick
// of the running phase: the caller's process reports it, and rules of the wiring apply (callers of one phase, callers in the own
// phase). Any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace corba {

// Describes what is nondeterministic in a call of this operation at this phase counter; empty if nothing is. A caller outside of a tick has
// phase counter 0.
std::string nondeterminism_of_call(std::string_view operation, std::uint64_t phase_counter, std::uint64_t phase_counter_of_caller = 0);

// Watches all further calls to this process. Calls from ticks of this process carry the phase counter from now on.
void watch_calls();

}  // namespace corba
