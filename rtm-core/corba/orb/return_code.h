// The return codes of core and of the wire, one as the other. Any thread.
#pragma once

#include "core/return_code.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

RTC::ReturnCode_t to_wire(rt::ReturnCode code);
rt::ReturnCode from_wire(RTC::ReturnCode_t code);

}  // namespace corba
