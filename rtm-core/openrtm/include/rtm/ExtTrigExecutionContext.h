// Runs one cycle per tick(), on a thread of its own. Every tick is a cycle, also those that come while one runs. Components change their
// state without a tick.
#pragma once

#include <rtm/ContextThread.h>
#include <rtm/idl/OpenRTMSkel.h>

namespace RTC {

class Manager;

class ExtTrigExecutionContext : public ThreadedExecutionContext<POA_OpenRTM::ExtTrigExecutionContextService> {
 public:
  ExtTrigExecutionContext();
  ~ExtTrigExecutionContext() override;

  // Returns at once. Ticks of a stopped context are forgotten.
  void tick() override;
};

}  // namespace RTC

extern "C" void ExtTrigExecutionContextInit(RTC::Manager* manager);
