#include "rtm/Callers.h"

#include "corba/orb/principal.h"

namespace RTC {

bool mayKeep(CORBA::Object_ptr object) { return corba::may_keep(object); }

}  // namespace RTC
