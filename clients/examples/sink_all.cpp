// SinkAll: prints what arrives at one InPort of every basic type and sequence type.
// The data types come before the ports, as OpenRTM-aist wants them.
#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/Manager.h>

#include <iostream>

#include "all_ports.h"

class SinkAll : public RTC::DataFlowComponentBase {
 public:
  explicit SinkAll(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}

  RTC::ReturnCode_t onInitialize() override {
    bindParameter("print", print_, "1");
    ports_.for_each([this](auto& bound) { addInPort(bound.name, bound.port); });
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    ports_.for_each([this](auto& bound) {
      while (bound.port.isNew()) {
        if (!bound.port.read()) return;
        if (print_) std::cout << bound.name << ": " << example::to_text(bound.value.data) << std::endl;
      }
    });
    return RTC::RTC_OK;
  }

 private:
  example::AllPorts<RTC::InPort> ports_;
  bool print_ = true;  // one line on stdout per value
};

// clang-format off
static const char* const sinkall_spec[] = {
    "implementation_id", "SinkAll",
    "type_name", "SinkAll",
    "description", "Prints what arrives at ports of all basic types",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "example",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "100",
    "conf.default.print", "1",
    "conf.__widget__.print", "radio",
    "conf.__constraints__.print", "(0,1)",
    "conf.__type__.print", "int",
    ""};
// clang-format on

extern "C" {
DLL_EXPORT void SinkAllInit(RTC::Manager* manager) {
  coil::Properties profile(sinkall_spec);
  manager->registerFactory(profile, RTC::Create<SinkAll>, RTC::Delete<SinkAll>);
}
}
