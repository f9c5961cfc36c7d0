// Wakes the loop of the simulator: for a request, a participant that joins or leaves, or a new subscription. Any thread.
#pragma once

#include "shm/segment.h"

namespace shm {

// `simulation` is the simulation iface's segment. A system call only when the server sleeps.
void call_attention(const Segment& simulation);
// The same from any iface of that server; does nothing when it has no simulation iface.
void call_server_of(const SegmentName& iface);

}  // namespace shm
