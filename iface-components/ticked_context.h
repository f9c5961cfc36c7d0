// An execution context of another process that is ticked from outside: OpenRTM::ExtTrigExecutionContextService and
// OpenRTM::LogicalTimeTriggeredEC. One thread at a time.
//
// tick() returns when the other side's tick() does. SynchExtTriggerEC and LogicalTimeTriggeredEC (with its default sync_tick) run their
// components in it, so our tick ends after theirs. An ExtTrigExecutionContext runs them on a thread of its own afterwards, and a caller
// cannot wait for that.
#pragma once

#include <base/result.h>
#include <rtm/idl/LogicalTimeTriggeredECStub.h>
#include <rtm/idl/OpenRTMStub.h>

#include <chrono>
#include <string>

namespace iface {

class TickedContext {
 public:
  // Of a stringified reference. Fails when it is none, when nobody answers there, or when the object is no such context.
  static base::Result<TickedContext> resolve(CORBA::ORB_ptr orb, const std::string& reference);

  enum class Answer { done, threw, gone };
  // At this simulated time. Waits without end for one that hangs. `why`: what was thrown.
  Answer tick(std::chrono::nanoseconds now, std::string& why);

 private:
  OpenRTM::ExtTrigExecutionContextService_var triggered_;
  OpenRTM::LogicalTimeTriggeredEC_var logical_;
};

}  // namespace iface
