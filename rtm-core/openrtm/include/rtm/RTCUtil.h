// Queries the kind of a component. Each function asks the object; any thread. Throws the system exception when it does not answer.
#pragma once

#include <rtm/idl/RTCSkel.h>

namespace RTC_Utils {

inline bool isDataFlowComponent(CORBA::Object_ptr object) {
  const RTC::DataFlowComponent_var narrowed = RTC::DataFlowComponent::_narrow(object);
  return !CORBA::is_nil(narrowed);
}
inline bool isFsmParticipant(CORBA::Object_ptr object) {
  const RTC::FsmParticipant_var narrowed = RTC::FsmParticipant::_narrow(object);
  return !CORBA::is_nil(narrowed);
}
inline bool isFsmObject(CORBA::Object_ptr object) {
  const RTC::FsmObject_var narrowed = RTC::FsmObject::_narrow(object);
  return !CORBA::is_nil(narrowed);
}
inline bool isMultiModeObject(CORBA::Object_ptr object) {
  const RTC::MultiModeObject_var narrowed = RTC::MultiModeObject::_narrow(object);
  return !CORBA::is_nil(narrowed);
}

}  // namespace RTC_Utils
