// FailOnRequest: each callback fails when the configuration says so, by a return code or by an exception.
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

#include <stdexcept>
#include <string>

class FailOnRequest : public RTC::DataFlowComponentBase {
 public:
  explicit FailOnRequest(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}

  RTC::ReturnCode_t onInitialize() override {
    bindParameter("fail_in", fail_in_, "");
    bindParameter("how", how_, "return");
    return outcome("onInitialize");
  }
  RTC::ReturnCode_t onFinalize() override { return outcome("onFinalize"); }
  RTC::ReturnCode_t onStartup(RTC::UniqueId) override { return outcome("onStartup"); }
  RTC::ReturnCode_t onShutdown(RTC::UniqueId) override { return outcome("onShutdown"); }
  RTC::ReturnCode_t onActivated(RTC::UniqueId) override { return outcome("onActivated"); }
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId) override { return outcome("onDeactivated"); }
  RTC::ReturnCode_t onExecute(RTC::UniqueId) override { return outcome("onExecute"); }
  RTC::ReturnCode_t onAborting(RTC::UniqueId) override { return outcome("onAborting"); }
  RTC::ReturnCode_t onError(RTC::UniqueId) override { return outcome("onError"); }
  RTC::ReturnCode_t onReset(RTC::UniqueId) override { return outcome("onReset"); }
  RTC::ReturnCode_t onStateUpdate(RTC::UniqueId) override { return outcome("onStateUpdate"); }
  RTC::ReturnCode_t onRateChanged(RTC::UniqueId) override { return outcome("onRateChanged"); }

 private:
  RTC::ReturnCode_t outcome(const std::string& callback) const {
    if (!coil::includes(fail_in_, callback, false)) return RTC::RTC_OK;
    if (how_ == "throw") throw std::runtime_error(callback + " fails on request");
    if (how_ == "throw_number") throw 42;
    return RTC::RTC_ERROR;
  }

  std::string fail_in_;  // the callbacks that fail, separated by commas
  std::string how_;      // "return", "throw" (a std::exception) or "throw_number" (something else)
};

// clang-format off
static const char* const failonrequest_spec[] = {
    "implementation_id", "FailOnRequest",
    "type_name", "FailOnRequest",
    "description", "Fails in the callbacks that its configuration names",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "example",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "100",
    "conf.default.fail_in", "",
    "conf.default.how", "return",
    "conf.__widget__.fail_in", "text",
    "conf.__widget__.how", "radio",
    "conf.__constraints__.how", "(return,throw,throw_number)",
    "conf.__type__.fail_in", "string",
    "conf.__type__.how", "string",
    ""};
// clang-format on

extern "C" {
DLL_EXPORT void FailOnRequestInit(RTC::Manager* manager) {
  coil::Properties profile(failonrequest_spec);
  manager->registerFactory(profile, RTC::Create<FailOnRequest>, RTC::Delete<FailOnRequest>);
}
}
