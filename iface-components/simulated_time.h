// Tells a component that is called in simulated time from one in real time. Any thread.
#pragma once

#include <base/clock.h>

namespace iface {

// True while the running context is one of simulated time, of this process or of another: nothing may wait for time to pass then, because
// time waits for us.
inline bool in_simulated_time() { return base::current_clock().is_simulated(); }

}  // namespace iface
