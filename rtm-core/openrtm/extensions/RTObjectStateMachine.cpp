#include "rtm/RTObjectStateMachine.h"

#include "base/clock.h"
#include "component/runtime_access.h"
#include "core/execution_context.h"

using RTC::RuntimeAccess;

namespace RTC_impl {

RTObjectStateMachine::RTObjectStateMachine(RTC::LightweightRTObject_ptr component, RTC::ExecutionContextHandle_t handle,
                                           RTC::ExecutionContextBase& context, std::uint64_t member)
    : component_(RTC::LightweightRTObject::_duplicate(component)), handle_(handle), context_(context), member_(member) {}

bool RTObjectStateMachine::isEquivalent(RTC::LightweightRTObject_ptr component) const {
  return !CORBA::is_nil(component) && component_->_is_equivalent(component);
}

RTC::LifeCycleState RTObjectStateMachine::getState() const {
  return static_cast<RTC::LifeCycleState>(RuntimeAccess::context(context_).state(member_));
}

RTC::LifeCycleState RTObjectStateMachine::getNextState() const {
  return static_cast<RTC::LifeCycleState>(RuntimeAccess::context(context_).next_state(member_));
}

void RTObjectStateMachine::goTo(RTC::LifeCycleState state) {
  const rt::State from = RuntimeAccess::context(context_).state(member_);
  for (const rt::Transition& transition : rt::transitions) {
    if (transition.from == from && static_cast<int>(transition.to) == state)
      RuntimeAccess::context(context_).request(member_, transition.event);
  }
}

void RTObjectStateMachine::workerPreDo() {
  const base::ScopedClock clock(RuntimeAccess::clock(context_));
  RuntimeAccess::context(context_).transit_one(member_);
}

void RTObjectStateMachine::workerDo() {
  const base::ScopedClock clock(RuntimeAccess::clock(context_));
  RuntimeAccess::context(context_).transit_one(member_);
  RuntimeAccess::context(context_).execute_one(member_);
}

void RTObjectStateMachine::workerPostDo() {
  const base::ScopedClock clock(RuntimeAccess::clock(context_));
  RuntimeAccess::context(context_).update_one(member_);
}

}  // namespace RTC_impl
