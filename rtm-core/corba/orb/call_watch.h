// Tells (base/chance.h) of calls from other processes that change something while the time of a lock step passes: when they come is chance.
// What comes while time stands still (before the first step, where the script of a run stops, after the last) is not. Reading calls,
// samples and the callbacks of contexts in other processes are no such calls, and neither are services that are called by a tick of the
// phase that runs: its process says so, and rules of the wiring hold for both (callers of one phase, and called in the own phase). Any
// thread.
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
