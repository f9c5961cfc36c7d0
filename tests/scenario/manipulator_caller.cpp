// The text with the module JARA_ARM.
#include <rtm/ext/ManipulatorCommonInterface_CommonSkel.h>
#include <rtm/ext/ManipulatorCommonInterface_MiddleSkel.h>

#define CALLER ManipulatorCaller
#define JARA JARA_ARM
#define MODULE "JARA_ARM::"
#define HAS_HOME
#include "manipulator_caller.h"

extern "C" {
DLL_EXPORT void ManipulatorCallerInit(RTC::Manager* manager) {
  coil::Properties profile = caller_profile("ManipulatorCaller");
  manager->registerFactory(profile, RTC::Create<ManipulatorCaller>, RTC::Delete<ManipulatorCaller>);
}
}
