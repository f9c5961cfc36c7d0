#include "rtm/LogicalTimeTriggeredEC.h"

#include <rtm/ECFactory.h>

#include "base/clock.h"
#include "component/context_clock.h"

namespace RTC {

struct LogicalTimeTriggeredEC::Time {
  base::ManualClock clock;
};

LogicalTimeTriggeredEC::LogicalTimeTriggeredEC() : ThreadedExecutionContext("logicaltime_ec", Beat::tick), time_(std::make_shared<Time>()) {
  const std::shared_ptr<const base::Clock> clock(time_, &time_->clock);
  set_clock(*this, clock, clock);
}

LogicalTimeTriggeredEC::~LogicalTimeTriggeredEC() { endThread(); }

void LogicalTimeTriggeredEC::tick(CORBA::ULong sec, CORBA::ULong usec) {
  addTickAndWait(std::chrono::seconds(sec) + std::chrono::microseconds(usec));
}

void LogicalTimeTriggeredEC::get_time(CORBA::ULong& sec, CORBA::ULong& usec) {
  const auto now = std::chrono::duration_cast<std::chrono::microseconds>(time_->clock.now());
  sec = static_cast<CORBA::ULong>(now / std::chrono::seconds(1));
  usec = static_cast<CORBA::ULong>((now % std::chrono::seconds(1)).count());
}

void LogicalTimeTriggeredEC::beginTick(std::chrono::nanoseconds time) { time_->clock.set(time); }

}  // namespace RTC

extern "C" void LogicalTimeTriggeredECInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("LogicalTimeTriggeredEC", RTC::ECCreate<RTC::LogicalTimeTriggeredEC>,
                                                      RTC::ECDelete<RTC::LogicalTimeTriggeredEC>);
}
