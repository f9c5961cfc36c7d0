#include <rtm/ExecutionContextWorker.h>

#include "component/runtime_access.h"

using RTC::RuntimeAccess;

namespace RTC_impl {

std::vector<std::shared_ptr<RTObjectStateMachine>> ExecutionContextWorker::members() const {
  std::vector<std::shared_ptr<RTObjectStateMachine>> machines;
  for (auto& member : RuntimeAccess::impl(context_).members()) machines.push_back(std::move(member.machine));
  return machines;
}

void ExecutionContextWorker::countCycle(std::chrono::nanoseconds took, std::chrono::nanoseconds waited) {
  RuntimeAccess::context(context_).count_cycle(took, waited);
}

RTObjectStateMachine* ExecutionContextWorker::findComponent(RTC::LightweightRTObject_ptr component) {
  const auto member = RuntimeAccess::impl(context_).find(component);
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

void ExecutionContextWorker::invokeWorker() { RuntimeAccess::cycle(context_); }
void ExecutionContextWorker::invokeWorkerPreDo() { RuntimeAccess::transit(context_); }
void ExecutionContextWorker::invokeWorkerDo() { RuntimeAccess::execute(context_); }
void ExecutionContextWorker::invokeWorkerPostDo() { RuntimeAccess::update(context_); }

}  // namespace RTC_impl
