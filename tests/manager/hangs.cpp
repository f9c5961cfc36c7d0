// Hangs: a component whose onExecute never returns, with a stream in its hands, as one that waits for input; HangsInMaking: one that takes
// its time to be made. For tests of how a process ends, and of modules that fail or go.
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <semaphore>
#include <stdexcept>

class Hangs : public RTC::DataFlowComponentBase {
 public:
  explicit Hangs(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}
  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    flockfile(stdin);
    std::cout << "hanging" << std::endl;
    never_.acquire();
    return RTC::RTC_OK;
  }

 private:
  std::binary_semaphore never_{0};
};

class HangsInMaking : public RTC::DataFlowComponentBase {
 public:
  explicit HangsInMaking(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {
    std::cout << "being made" << std::endl;
    static_cast<void>(std::binary_semaphore(0).try_acquire_for(std::chrono::seconds(2)));
  }
};

static const char* const hangs_spec[] = {
    "implementation_id", "Hangs",   "type_name", "Hangs",    "description", "Never returns", "category", "test", "vendor",
    "rtm-sim",           "version", "1.0.0",     "language", "C++",         "lang_type",     "compile",  ""};

extern "C" {
DLL_EXPORT void HangsInit(RTC::Manager* manager) {
  coil::Properties profile(hangs_spec);
  manager->registerFactory(profile, RTC::Create<Hangs>, RTC::Delete<Hangs>);
}
DLL_EXPORT void HangsInMakingInit(RTC::Manager* manager) {
  coil::Properties profile(hangs_spec);
  profile.setProperty("implementation_id", "HangsInMaking");
  profile.setProperty("type_name", "HangsInMaking");
  manager->registerFactory(profile, RTC::Create<HangsInMaking>, RTC::Delete<HangsInMaking>);
}
// Registers the component and then fails.
DLL_EXPORT void HangsFailInit(RTC::Manager* manager) {
  HangsInit(manager);
  throw std::runtime_error("no licence");
}
}
