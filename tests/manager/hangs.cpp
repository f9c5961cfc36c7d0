// Hangs: a component whose onExecute never returns. For tests of how a process ends, and of modules that fail.
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

#include <iostream>
#include <semaphore>
#include <stdexcept>

class Hangs : public RTC::DataFlowComponentBase {
 public:
  explicit Hangs(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}
  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    std::cout << "hanging" << std::endl;
    never_.acquire();
    return RTC::RTC_OK;
  }

 private:
  std::binary_semaphore never_{0};
};

static const char* const hangs_spec[] = {
    "implementation_id", "Hangs",   "type_name", "Hangs",    "description", "Never returns", "category", "test", "vendor",
    "rtm-sim",           "version", "1.0.0",     "language", "C++",         "lang_type",     "compile",  ""};

extern "C" {
DLL_EXPORT void HangsInit(RTC::Manager* manager) {
  coil::Properties profile(hangs_spec);
  manager->registerFactory(profile, RTC::Create<Hangs>, RTC::Delete<Hangs>);
}
// Registers the component and then fails.
DLL_EXPORT void HangsFail(RTC::Manager* manager) {
  HangsInit(manager);
  throw std::runtime_error("no licence");
}
}
