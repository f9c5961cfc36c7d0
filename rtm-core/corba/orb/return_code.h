// Converts return codes between core and the wire. Any thread.
#pragma once

#include "core/return_code.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

RTC::ReturnCode_t to_wire(rt::ReturnCode code);
rt::ReturnCode from_wire(RTC::ReturnCode_t code);

}  // namespace corba
