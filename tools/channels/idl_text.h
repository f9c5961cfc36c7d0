// The definition of a data type as OMG IDL, self-contained: readers of a recording need it to decode samples. Pure; any
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
