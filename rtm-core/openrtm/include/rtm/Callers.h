// The caller of a service of a component (docs/security.md). No part of the API of OpenRTM. Any thread.
#pragma once

#include <omniORB4/CORBA.h>

namespace RTC {

// To be asked within the call of a service, about a reference that came with it and is to be called later: false when the caller is of
// another account or host and the object does not answer it, because it lives in a process that does not let him in. Nil may be kept.
bool mayKeep(CORBA::Object_ptr object);

}  // namespace RTC
