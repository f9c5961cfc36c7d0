#include "served_objects.h"

namespace iface {

bool is_gone(CORBA::ORB_ptr orb, const std::string& reference) {
  constexpr CORBA::ULong timeout = 1000;  // [ms]
  try {
    // A reference of its own, so that the time-out is for this call alone.
    CORBA::Object_var own = orb->string_to_object(reference.c_str());
    omniORB::setClientCallTimeout(own, timeout);
    return own->_non_existent();
  } catch (const CORBA::TRANSIENT& exception) {
    return exception.minor() != omni::TRANSIENT_CallTimedout;
  } catch (const CORBA::COMM_FAILURE&) {
    return true;
  } catch (const CORBA::OBJECT_NOT_EXIST&) {
    return true;
  } catch (const CORBA::Exception&) {
    return false;
  }
}

std::vector<std::string> members_of(CORBA::ORB_ptr orb, RTC::ExecutionContext_ptr context) {
  std::vector<std::string> members;
  try {
    const RTC::ExecutionContextService_var service = RTC::ExecutionContextService::_narrow(context);
    if (CORBA::is_nil(service)) return members;
    const RTC::ExecutionContextProfile_var profile = service->get_profile();
    for (CORBA::ULong i = 0; i < profile->participants.length(); ++i) {
      if (CORBA::is_nil(profile->participants[i]) || profile->participants[i]->_is_equivalent(profile->owner)) continue;
      const CORBA::String_var reference = orb->object_to_string(profile->participants[i]);
      members.emplace_back(reference.in());
    }
  } catch (const CORBA::Exception&) {
    // The context is just going.
  }
  return members;
}

}  // namespace iface
