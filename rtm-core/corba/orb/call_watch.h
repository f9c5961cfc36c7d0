// Reports (base/chance.h) calls from other processes that change something while lock-step time passes: their time is
// nondeterministic. Calls while time is paused (before the first step, at a stop of a run script, after the last step) are not
// reported. Reading calls, samples and callbacks of contexts in other processes are not reported either, nor services called by a tick
// of the running phase: the caller's process reports it, and rules of the wiring apply (callers of one phase, callers in the own
// phase). Any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace corba {

// What a call of this operation at this moment leaves to chance, for a line of text; empty: nothing. A caller that is in no tick has moment
// 0.
std::string chance_of_call(std::string_view operation, std::uint64_t moment, std::uint64_t moment_of_caller = 0);

// From now on, of all calls that come into this process; and its own ticks say their moment where they call.
void watch_calls();

}  // namespace corba
