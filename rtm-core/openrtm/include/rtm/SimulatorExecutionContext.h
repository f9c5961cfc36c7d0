// An OpenHRPExecutionContext whose components have changed their state when activate, deactivate or reset returns, whatever sync_transition
// says.
#pragma once

#include <rtm/OpenHRPExecutionContext.h>

namespace RTC {

class SimulatorExecutionContext : public OpenHRPExecutionContext {
 public:
  SimulatorExecutionContext();

  RTC::ReturnCode_t activate_component(RTC::LightweightRTObject_ptr comp) override;
  RTC::ReturnCode_t deactivate_component(RTC::LightweightRTObject_ptr comp) override;
  RTC::ReturnCode_t reset_component(RTC::LightweightRTObject_ptr comp) override;
};

}  // namespace RTC

extern "C" void SimulatorExecutionContextInit(RTC::Manager* manager);
