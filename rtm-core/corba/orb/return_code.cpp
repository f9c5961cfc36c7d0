#include "corba/orb/return_code.h"

namespace corba {

RTC::ReturnCode_t to_wire(rt::ReturnCode code) { return static_cast<RTC::ReturnCode_t>(code); }
rt::ReturnCode from_wire(RTC::ReturnCode_t code) { return static_cast<rt::ReturnCode>(code); }

}  // namespace corba
