// Time stamps of timed values: simulated time inside an execution context on simulated time, else the wall clock. Any thread.
#pragma once

#include "rtm/DataType.h"

// Sets value.tm to now.
template <class DataType>
void setTimestamp(DataType& value) {
  const auto now = RTC::detail::current_stamp();
  RTC::detail::TypeFunctions<DataType>::stamp(&value, now.seconds, now.nanoseconds);
}

namespace RTC {
using ::setTimestamp;

// True while this thread runs a callback for an execution context in simulated time. Such a callback must not wait for time to pass, and
// must not let the wall clock decide what it does. OpenRTM-aist has no such function.
bool inSimulatedTime();
}  // namespace RTC
