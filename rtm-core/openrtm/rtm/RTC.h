// What every header of the component API starts from: the interfaces of the RTC standard and the names authors use for them. Any thread.
#pragma once

#include <rtm/version.h>

#include <rtm/idl/RTCSkel.h>

namespace RTC {

using UniqueId = ExecutionContextHandle_t;

class RTObject_impl;
using RtcBase = RTObject_impl;

}  // namespace RTC
