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

// Calls notify_disconnect. Returns nothing if the port is dead or does not respond within about a second. `left`: number of ports of the
// chain from this one on; each of them may find that the next one hangs. A process that did not respond is notified later if it responds
// within the timeout of calls between ports. Until then no call waits for it. After the deadline no call waits at all.
std::optional<RTC::ReturnCode_t> notify_disconnect_of(RTC::PortService_ptr port, const char* connector_id, CORBA::ULong left,
                                                      const ChainDeadline& deadline);

// The deadline for the calls of notify_disconnect_of to all ports of one connection. `has_waited`: a port of it has just used up its
// timeout, so no further call waits.
ChainDeadline disconnect_deadline(bool has_waited = false);

// For a connection that was dropped because the port's process did not respond. Calls notify_disconnect of the port as soon as the process
// responds, within ten minutes. Does nothing if the process is dead. Returns at once.
void notify_disconnect_later(RTC::PortService_ptr port, const char* connector_id);
// The same for a connection that shall be restored: then connects again with the profile. Tries for a day, also while the other machine
// cannot be reached.
void reconnect_later(RTC::PortService_ptr port, const RTC::ConnectorProfile& profile);

// Later notifications are sent only between these two calls, while the ORB exists. The second one waits a limited time for calls in
// progress.
void start_disconnect_notices();
void stop_disconnect_notices();

}  // namespace corba
