// Runs one cycle per tick, on a thread of its own, at the logical time that the tick brings: it is the clock of the components while they
// are called. Every tick is a cycle, in the order in which they came, also those that come while one runs. Components change their state
// without a tick.
#pragma once

#include <rtm/ContextThread.h>
#include <rtm/idl/LogicalTimeTriggeredECSkel.h>

#include <memory>

namespace RTC {

class Manager;

class LogicalTimeTriggeredEC : public ThreadedExecutionContext<POA_OpenRTM::LogicalTimeTriggeredEC> {
 public:
  LogicalTimeTriggeredEC();
  ~LogicalTimeTriggeredEC() override;

  // Returns when its cycle is over, as in OpenRTM; from within a cycle at once. A million microseconds and more are carried over. Ticks of
  // a stopped context are forgotten.
  void tick(CORBA::ULong sec, CORBA::ULong usec) override;
  // The time of the cycle that runs or ran last; 0 before the first.
  void get_time(CORBA::ULong& sec, CORBA::ULong& usec) override;

 protected:
  void beginTick(std::chrono::nanoseconds time) override;

 private:
  struct Time;
  const std::shared_ptr<Time> time_;
};

}  // namespace RTC

extern "C" void LogicalTimeTriggeredECInit(RTC::Manager* manager);
