// Wakes the server's loop when it sleeps: somebody asks, joins, leaves, or has switched a sensor on or off. Any thread.
#pragma once

#include "shm/segment.h"

namespace shm {

// `simulation` is the simulation iface's segment. A system call only when the server sleeps.
void call_attention(const Segment& simulation);
// The same from any iface of that server; does nothing when it has no simulation iface.
void call_server_of(const SegmentName& iface);

}  // namespace shm
