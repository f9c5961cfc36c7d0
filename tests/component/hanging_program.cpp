// A program with a manager whose components hang on request: configuration `hang` names the callback that never returns; `where: others`
// lets onExecute hang in the contexts of others instead of the own.
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <string>

#include "support/usage.h"

namespace {

class Hanging : public RTC::DataFlowComponentBase {
 public:
  explicit Hanging(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}

  RTC::ReturnCode_t onInitialize() override { return maybe_hang("onInitialize"); }
  RTC::ReturnCode_t onFinalize() override { return maybe_hang("onFinalize"); }
  RTC::ReturnCode_t onStartup(RTC::UniqueId) override { return maybe_hang("onStartup"); }
  RTC::ReturnCode_t onShutdown(RTC::UniqueId) override { return maybe_hang("onShutdown"); }
  RTC::ReturnCode_t onActivated(RTC::UniqueId) override { return maybe_hang("onActivated"); }
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId) override { return maybe_hang("onDeactivated"); }
  RTC::ReturnCode_t onExecute(RTC::UniqueId id) override {
    return isOwnExecutionContext(id) == (setting("where") == "own") ? maybe_hang("onExecute") : RTC::RTC_OK;
  }

 private:
  std::string setting(const char* name) { return m_configsets.getConfigurationSet("default").getProperty(name); }
  RTC::ReturnCode_t maybe_hang(const std::string& callback) {
    if (setting("hang") != callback) return RTC::RTC_OK;
    std::printf("%s stands in %s\n", getInstanceName(), callback.c_str());
    std::fflush(stdout);
    std::mutex mutex;
    std::condition_variable never;
    std::unique_lock lock(mutex);
    never.wait(lock, [] { return false; });
    return RTC::RTC_OK;
  }
};

const char* const spec[] = {"implementation_id", "Hanging", "type_name",          "Hanging", "category", "test", "language", "C++",
                            "conf.default.hang", "",        "conf.default.where", "own",     ""};

void init(RTC::Manager* manager) {
  coil::Properties profile(spec);
  manager->registerFactory(profile, RTC::Create<Hanging>, RTC::Delete<Hanging>);
}

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv,
                      "hanging_program [OPTION_OF_MANAGER]...\nIs a component host whose components hang on request, for tests.");
  RTC::Manager* manager = RTC::Manager::init(argc, argv);
  manager->setModuleInitProc(init);
  manager->activateManager();
  std::printf("ready\n");
  std::fflush(stdout);
  manager->runManager();
  return 0;
}
