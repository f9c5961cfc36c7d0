// EchoConsumer: calls the service Example::EchoService once per cycle and prints the answer.
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

// The ports come after the component's base, as OpenRTM-aist wants them.
#include <rtm/CorbaConsumer.h>
#include <rtm/CorbaPort.h>

#include <iostream>
#include <string>

#include "EchoStub.h"

class EchoConsumer : public RTC::DataFlowComponentBase {
 public:
  explicit EchoConsumer(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}

  RTC::ReturnCode_t onInitialize() override {
    bindParameter("text", text_, "hello");
    port_.registerConsumer("echo0", "Example::EchoService", echo_);
    addPort(port_);
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    if (CORBA::is_nil(echo_._ptr())) return RTC::RTC_OK;  // not connected
    try {
      CORBA::String_var answer = echo_->echo((text_ + " " + std::to_string(++calls_)).c_str());
      std::cout << "echo: " << answer << std::endl;
    } catch (const CORBA::SystemException& e) {
      // The provider is not active or has gone; the next cycle tries again.
      RTC_WARN(("echo failed: %s", e._name()));
    }
    return RTC::RTC_OK;
  }

 private:
  RTC::CorbaPort port_{"Echo"};
  RTC::CorbaConsumer<Example::EchoService> echo_;
  std::string text_;
  unsigned long calls_ = 0;
};

// clang-format off
static const char* const echoconsumer_spec[] = {
    "implementation_id", "EchoConsumer",
    "type_name", "EchoConsumer",
    "description", "Calls an echo service once per cycle",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "example",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "1",
    "conf.default.text", "hello",
    "conf.__widget__.text", "text",
    "conf.__type__.text", "string",
    ""};
// clang-format on

extern "C" {
DLL_EXPORT void EchoConsumerInit(RTC::Manager* manager) {
  coil::Properties profile(echoconsumer_spec);
  manager->registerFactory(profile, RTC::Create<EchoConsumer>, RTC::Delete<EchoConsumer>);
}
}
