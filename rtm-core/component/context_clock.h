// The clock of an execution context on simulated time. Not installed.
#pragma once

#include <rtm/ExecutionContextBase.h>

#include <memory>

#include "base/clock.h"

namespace RTC {

// In the constructor of a context, before anybody else knows it. `of_ticks`: the current clock of its components while they are called.
// `of_others`: what time it is for the components now, for threads that the context does not run, such as those that receive data for
// them. Both may outlive the context.
void set_clock(ExecutionContextBase& context, std::shared_ptr<const base::Clock> of_ticks, std::shared_ptr<const base::Clock> of_others);

}  // namespace RTC
