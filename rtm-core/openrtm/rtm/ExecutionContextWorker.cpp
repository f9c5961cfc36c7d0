#include <rtm/ExecutionContextWorker.h>
#include "component/context_impl.h"

namespace RTC_impl {

std::vector<std::shared_ptr<RTObjectStateMachine>> ExecutionContextWorker::members() const {
  std::vector<std::shared_ptr<RTObjectStateMachine>> machines;
  for (auto& member : context_.impl_->members()) machines.push_back(std::move(member.machine));
  return machines;
}

void ExecutionContextWorker::countCycle(std::chrono::nanoseconds took, std::chrono::nanoseconds waited) {
  context_.context().count_cycle(took, waited);
}

RTObjectStateMachine* ExecutionContextWorker::findComponent(RTC::LightweightRTObject_ptr component) {
  const auto member = context_.impl_->find(component);
  return member ? member->machine.get() : nullptr;
}

bool ExecutionContextWorker::isRunning() const { return context_.isRunning(); }

RTC::LifeCycleState ExecutionContextWorker::getComponentState(RTC::LightweightRTObject_ptr component) const {
  return context_.getComponentState(component);
}

bool ExecutionContextWorker::isAllCurrentState(RTC::LifeCycleState state) const { return context_.isAllCurrentState(state); }
bool ExecutionContextWorker::isAllNextState(RTC::LifeCycleState state) const { return context_.isAllNextState(state); }
bool ExecutionContextWorker::isOneOfCurrentState(RTC::LifeCycleState state) const { return context_.isOneOfCurrentState(state); }
bool ExecutionContextWorker::isOneOfNextState(RTC::LifeCycleState state) const { return context_.isOneOfNextState(state); }

void ExecutionContextWorker::invokeWorker() { context_.invokeWorker(); }
void ExecutionContextWorker::invokeWorkerPreDo() { context_.invokeWorkerPreDo(); }
void ExecutionContextWorker::invokeWorkerDo() { context_.invokeWorkerDo(); }
void ExecutionContextWorker::invokeWorkerPostDo() { context_.invokeWorkerPostDo(); }

}  // namespace RTC_impl
