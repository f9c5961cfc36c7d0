// Disconnect notices: notifies other ports that a connection ended, with a short timeout for hanging ones. Any thread; no lock is held
// while it calls.
//
// A disconnect waits one second for a process that hangs, for any number of connections to it. The process is notified in the background if
// it responds within the usual timeout. A process that was dropped because it hung is notified if it responds within ten minutes, so that
// it can be connected again.
#pragma once

#include <optional>

#include "corba/orb/call_timeout.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

// notify_disconnect; nothing if the port is dead or does not answer in about a second. `left`: ports of the chain from this one on, each of
// which may find that the next one hangs. The process that did not answer is told later, if it wakes within the time-out of calls between
// ports; until that is known nobody waits for it any more. After the deadline nobody is waited for at all.
std::optional<RTC::ReturnCode_t> take_leave(RTC::PortService_ptr port, const char* connector_id, CORBA::ULong left,
                                            const ChainDeadline& deadline);

// The deadline for the calls of take_leave to all ports of one connection. `has_waited`: a port of it has taken its whole time-out just
// now, so nobody is waited for again.
ChainDeadline farewell_deadline(bool has_waited = false);

// For a connection that was dropped because the port's process did not answer: says notify_disconnect to the port when the process has
// woken, within ten minutes; nothing if it is dead. Returns at once.
void take_leave_when_awake(RTC::PortService_ptr port, const char* connector_id);
// The same for a connection that is to come back: then connects anew, as the profile says. Goes on for a day, also while the other host
// cannot be reached.
void reconnect_when_awake(RTC::PortService_ptr port, const RTC::ConnectorProfile& profile);

// Only between these two are those that did not answer told later: while there is an ORB. The end waits for the calls in progress, a
// moment.
void begin_farewells();
void end_farewells();

}  // namespace corba
