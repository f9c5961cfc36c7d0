// The objects that an object serves, and whether any of them still exists. Any thread.
#pragma once

#include <rtm/idl/RTCStub.h>

#include <string>
#include <vector>

namespace iface {

// Its process has ended, or the object has gone. One that hangs is there: it is asked, and waited for, for a second.
bool is_gone(CORBA::ORB_ptr orb, const std::string& reference);

// References of the members of a context, but for its owner.
std::vector<std::string> members_of(CORBA::ORB_ptr orb, RTC::ExecutionContext_ptr context);

}  // namespace iface
