// The m_worker of contexts that authors write: the members of their context one by one, and the cycle. Any thread, except the invoke
// functions, which are the context's own thread's.
#pragma once

#include <rtm/RTObjectStateMachine.h>

#include <chrono>
#include <memory>
#include <vector>

namespace RTC {
class ExecutionContextBase;
}

namespace RTC_impl {

class ExecutionContextWorker {
 public:
  explicit ExecutionContextWorker(RTC::ExecutionContextBase& context) : context_(context) {}
  ExecutionContextWorker(const ExecutionContextWorker&) = delete;
  ExecutionContextWorker& operator=(const ExecutionContextWorker&) = delete;

  std::vector<std::shared_ptr<RTObjectStateMachine>> members() const;
  // nullptr when it is no member. Good until the component has left, and a while longer.
  RTObjectStateMachine* findComponent(RTC::LightweightRTObject_ptr component);
  bool isRunning() const;
  RTC::LifeCycleState getComponentState(RTC::LightweightRTObject_ptr component) const;
  bool isAllCurrentState(RTC::LifeCycleState state) const;
  bool isAllNextState(RTC::LifeCycleState state) const;
  bool isOneOfCurrentState(RTC::LifeCycleState state) const;
  bool isOneOfNextState(RTC::LifeCycleState state) const;
  void invokeWorker();
  void invokeWorkerPreDo();
  void invokeWorkerDo();
  void invokeWorkerPostDo();
  // For cycles whose members are stepped one by one.
  void countCycle(std::chrono::nanoseconds took, std::chrono::nanoseconds waited);
  // Each stage detects added and removed members itself.
  void updateComponentList() {}

 private:
  RTC::ExecutionContextBase& context_;
};

}  // namespace RTC_impl
