// The definition of a data type as text in OMG IDL, complete in itself: what a reader of a recording needs to decode its samples. Pure; any
// thread.
#pragma once

#include <string>

#include "rtm/idl/RTCStub.h"

namespace channels {

// "IDL:RTC/TimedLong:1.0" -> "RTC::TimedLong".
std::string scoped_name(const std::string& repository_id);
// Typedefs are written out; every structure and enumeration stands before it is used.
std::string idl_text(CORBA::TypeCode_ptr type);

}  // namespace channels
