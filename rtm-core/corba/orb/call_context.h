// Our service contexts: a call to another process carries facts of the tick that makes it. ORBs pass over contexts that they do not know
// (CORBA 3.3 part 2, 9.3.1). Any thread.
//   "RTS" 1   the phase counter of a tick in lock step, with the operations of services (corba/orb/call_watch.h)
//   "RTS" 2   the time, with callbacks and with tick() of a context on simulated time: the code that runs there runs in simulated time, too
//   "RTS" 3   its principal (corba/orb/principal.h), when that is not our own account
// Each is a number as a CDR encapsulation.
#pragma once

#include <omniORB4/CORBA.h>

#include <cstdint>
#include <optional>

#include "base/clock.h"

namespace corba {

enum class CallContext : std::uint32_t { phase_counter = 0x52545301, time = 0x52545302, principal = 0x52545303 };

void add_to_call(IOP::ServiceContextList& contexts, CallContext which, std::uint64_t number);
std::optional<std::uint64_t> said_by_call(const IOP::ServiceContextList& contexts, CallContext which);

// From now on callbacks and ticks say their time, and it is remembered of those that come into this process.
void pass_on_time();

// The time that the call from another process which this thread carries out has said; nullptr: it has said none, or there is no call.
const base::Clock* clock_of_caller();

}  // namespace corba
