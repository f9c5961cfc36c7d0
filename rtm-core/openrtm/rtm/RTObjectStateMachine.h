// One component inside one execution context, as the hooks of ExecutionContextBase see it. A value: copies name the same member. Any
// thread.
#pragma once

#include <rtm/idl/RTCSkel.h>

#include <cstdint>
#include <string>

namespace rt {
class ExecutionContext;
}
namespace RTC {
class ExecutionContextBase;
}

namespace RTC_impl {

class RTObjectStateMachine {
 public:
  RTObjectStateMachine(RTC::LightweightRTObject_ptr component, RTC::ExecutionContextHandle_t handle, rt::ExecutionContext& context,
                       std::uint64_t member, bool owner);

  RTC::LightweightRTObject_ptr getRTObject() const { return RTC::LightweightRTObject::_duplicate(component_); }
  bool isEquivalent(RTC::LightweightRTObject_ptr component) const;
  RTC::ExecutionContextHandle_t getExecutionContextHandle() const { return handle_; }

  RTC::LifeCycleState getState() const;
  RTC::LifeCycleState getNextState() const;
  bool isCurrentState(RTC::LifeCycleState state) const { return getState() == state; }
  bool isNextState(RTC::LifeCycleState state) const { return getNextState() == state; }

 private:
  friend class RTC::ExecutionContextBase;
  RTC::LightweightRTObject_var component_;
  RTC::ExecutionContextHandle_t handle_;
  rt::ExecutionContext* context_;
  std::uint64_t member_;
  bool owner_;  // the component owns the context; else it participates
};

}  // namespace RTC_impl
