// Runs one cycle per tick, on a thread of its own, at the logical time that the tick brings: it is the clock of the components while they
// are called. Every tick is a cycle, in the order in which they came, also those that come while one runs. Components change their state
// without a tick.
#pragma once

#include <coil/Task.h>
#include <rtm/ExecutionContextServant.h>
#include <rtm/idl/LogicalTimeTriggeredECSkel.h>

#include <memory>

namespace base {
class Clock;
}

namespace RTC {

class Manager;

class LogicalTimeTriggeredEC : public ExecutionContextServant<POA_OpenRTM::LogicalTimeTriggeredEC>, public coil::Task {
 public:
  LogicalTimeTriggeredEC();
  ~LogicalTimeTriggeredEC() override;

  // Returns when its cycle is over, as in OpenRTM; from within a cycle at once. A million microseconds and more are carried over. Ticks of
  // a stopped context are forgotten.
  void tick(CORBA::ULong sec, CORBA::ULong usec) override;
  // The time of the cycle that runs or ran last; 0 before the first.
  void get_time(CORBA::ULong& sec, CORBA::ULong& usec) override;

  int open(void* args) override;
  int svc() override;
  int close(unsigned long flags) override;

  // Both bases have operations of these names; components call the context's.
  RTC::ReturnCode_t start() override { return ExecutionContextBase::start(); }
  RTC::ReturnCode_t stop() override { return ExecutionContextBase::stop(); }

 protected:
  RTC::ReturnCode_t onStarted() override;
  RTC::ReturnCode_t onStopping() override;
  void onWakeUp() override;
  const base::Clock& contextClock() const override;
  std::shared_ptr<const base::Clock> sharedClock() const override;

 private:
  class Steps;
  struct Time;
  const std::shared_ptr<Time> clock_;
  std::unique_ptr<Steps> steps_;
  class Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace RTC

extern "C" void LogicalTimeTriggeredECInit(RTC::Manager* manager);
