#include "rtm/ExtTrigExecutionContext.h"

#include <rtm/ECFactory.h>

namespace RTC {

ExtTrigExecutionContext::ExtTrigExecutionContext() : ThreadedExecutionContext("exttrig_async_ec", Beat::tick) {}
ExtTrigExecutionContext::~ExtTrigExecutionContext() { endThread(); }

void ExtTrigExecutionContext::tick() { addTick(); }

}  // namespace RTC

extern "C" void ExtTrigExecutionContextInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("ExtTrigExecutionContext", RTC::ECCreate<RTC::ExtTrigExecutionContext>,
                                                      RTC::ECDelete<RTC::ExtTrigExecutionContext>);
}
