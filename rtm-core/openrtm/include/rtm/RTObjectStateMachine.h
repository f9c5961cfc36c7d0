// One component inside one execution context, as contexts of authors and the hooks of ExecutionContextBase see it. Any thread, except the
// worker functions, which are the context's own thread's.
#pragma once

#include <rtm/idl/RTCSkel.h>

#include <cstdint>

namespace RTC {
class ExecutionContextBase;
}

namespace RTC_impl {

class RTObjectStateMachine {
 public:
  RTObjectStateMachine(RTC::LightweightRTObject_ptr component, RTC::ExecutionContextHandle_t handle, RTC::ExecutionContextBase& context,
                       std::uint64_t member);

  RTC::LightweightRTObject_ptr getRTObject() const { return RTC::LightweightRTObject::_duplicate(component_); }
  bool isEquivalent(RTC::LightweightRTObject_ptr component) const;
  RTC::ExecutionContextHandle_t getExecutionContextHandle() const { return handle_; }

  // CREATED_STATE once the component has left.
  RTC::LifeCycleState getState() const;
  RTC::LifeCycleState getNextState() const;
  bool isCurrentState(RTC::LifeCycleState state) const { return getState() == state; }
  bool isNextState(RTC::LifeCycleState state) const { return getNextState() == state; }

  // Asks for the transition to that state, which the next workerPreDo makes. Nothing happens when there is none.
  void goTo(RTC::LifeCycleState state);
  // The parts of a cycle for this component alone: transitions; onExecute (onError); onStateUpdate. workerDo makes a transition that
  // waits, for loops that call nothing else.
  void workerPreDo();
  void workerDo();
  void workerPostDo();

 private:
  RTC::LightweightRTObject_var component_;
  RTC::ExecutionContextHandle_t handle_;
  RTC::ExecutionContextBase& context_;
  std::uint64_t member_;
};

}  // namespace RTC_impl
