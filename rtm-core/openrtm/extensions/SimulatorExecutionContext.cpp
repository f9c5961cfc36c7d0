#include "rtm/SimulatorExecutionContext.h"

#include <rtm/ECFactory.h>

namespace RTC {

SimulatorExecutionContext::SimulatorExecutionContext() : OpenHRPExecutionContext("simulator_ec") {}

RTC::ReturnCode_t SimulatorExecutionContext::activate_component(RTC::LightweightRTObject_ptr comp) {
  const auto code = activateComponent(comp);
  transitNow();
  return code;
}

RTC::ReturnCode_t SimulatorExecutionContext::deactivate_component(RTC::LightweightRTObject_ptr comp) {
  const auto code = deactivateComponent(comp);
  transitNow();
  return code;
}

RTC::ReturnCode_t SimulatorExecutionContext::reset_component(RTC::LightweightRTObject_ptr comp) {
  const auto code = resetComponent(comp);
  transitNow();
  return code;
}

}  // namespace RTC

extern "C" void SimulatorExecutionContextInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("SimulatorExecutionContext", RTC::ECCreate<RTC::SimulatorExecutionContext>,
                                                      RTC::ECDelete<RTC::SimulatorExecutionContext>);
}
