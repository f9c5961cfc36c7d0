#include <rtm/RTObjectStateMachine.h>

#include "core/execution_context.h"

namespace RTC_impl {

RTObjectStateMachine::RTObjectStateMachine(RTC::LightweightRTObject_ptr component, RTC::ExecutionContextHandle_t handle,
                                           rt::ExecutionContext& context, std::uint64_t member, bool owner)
    : component_(RTC::LightweightRTObject::_duplicate(component)), handle_(handle), context_(&context), member_(member), owner_(owner) {}

bool RTObjectStateMachine::isEquivalent(RTC::LightweightRTObject_ptr component) const {
  return !CORBA::is_nil(component) && component_->_is_equivalent(component);
}

RTC::LifeCycleState RTObjectStateMachine::getState() const { return static_cast<RTC::LifeCycleState>(context_->state(member_)); }

RTC::LifeCycleState RTObjectStateMachine::getNextState() const { return static_cast<RTC::LifeCycleState>(context_->next_state(member_)); }

}  // namespace RTC_impl
