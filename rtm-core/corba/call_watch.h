// Tells (base/chance.h) of calls from other processes that change something while the time of a lock step passes: when they come is chance.
// What comes while time stands still (before the first step, where the script of a run stops, after the last) is not. Reading calls,
// samples and the callbacks of contexts in other processes are no such calls. Any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace corba {

// What a call of this operation at this moment leaves to chance, for a line of text; empty: nothing.
std::string chance_of_call(std::string_view operation, std::uint64_t moment);

// From now on, of all calls that come into this process.
void watch_calls();

}  // namespace corba
