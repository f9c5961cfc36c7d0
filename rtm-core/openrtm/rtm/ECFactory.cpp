#include <rtm/ECFactory.h>
#include <rtm/ExtTrigExecutionContext.h>
#include <rtm/LogicalTimeTriggeredEC.h>
#include <rtm/MultilayerCompositeEC.h>
#include <rtm/PeriodicExecutionContext.h>
#include <rtm/SimulatorExecutionContext.h>

namespace RTC {

void registerBuiltinExecutionContexts(RTC::Manager* manager) {
  PeriodicExecutionContextInit(manager);
  ExtTrigExecutionContextInit(manager);
  OpenHRPExecutionContextInit(manager);
  SimulatorExecutionContextInit(manager);
  MultilayerCompositeECInit(manager);
  LogicalTimeTriggeredECInit(manager);
}

}  // namespace RTC
