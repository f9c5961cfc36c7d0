// Time stamps of timed values: simulated time inside an execution context on simulated time, else the wall clock. Any thread.
#pragma once

#include "base/clock.h"
#include "corba/type_ops.h"

// Sets value.tm to now.
template <class DataType>
void setTimestamp(DataType& value) {
  corba::stamp_value<DataType>(&value, base::current_clock().now());
}

namespace RTC {
using ::setTimestamp;
}
