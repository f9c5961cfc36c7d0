// The text without a module.
#include "ManipulatorWithoutModuleStub.h"

#define CALLER ManipulatorCallerWithoutModule
#define JARA
#define MODULE ""
#include "manipulator_caller.h"

extern "C" {
DLL_EXPORT void ManipulatorCallerWithoutModuleInit(RTC::Manager* manager) {
  coil::Properties profile = caller_profile("ManipulatorCallerWithoutModule");
  manager->registerFactory(profile, RTC::Create<ManipulatorCallerWithoutModule>, RTC::Delete<ManipulatorCallerWithoutModule>);
}
}
