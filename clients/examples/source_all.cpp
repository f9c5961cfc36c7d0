// SourceAll: counts, and writes the count to one OutPort of every basic type and sequence type.
// The data types come before the ports, as OpenRTM-aist wants them.
#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>

#include <cstdint>

#include "all_ports.h"

class SourceAll : public RTC::DataFlowComponentBase {
 public:
  explicit SourceAll(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}

  RTC::ReturnCode_t onInitialize() override {
    bindParameter("start", start_, "1");
    bindParameter("length", length_, "3");
    ports_.for_each([this](auto& bound) { addOutPort(bound.name, bound.port); });
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onActivated(RTC::UniqueId) override {
    count_ = start_;
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onExecute(RTC::UniqueId) override {
    ports_.for_each([this](auto& bound) {
      example::set_number(bound.value.data, count_, length_);
      setTimestamp(bound.value);
      bound.port.write();
    });
    ++count_;
    return RTC::RTC_OK;
  }

 private:
  example::AllPorts<RTC::OutPort> ports_;
  std::uint32_t start_ = 1;   // the first number after activation
  std::uint32_t length_ = 3;  // of the sequences
  unsigned long count_ = 1;
};

// clang-format off
static const char* const sourceall_spec[] = {
    "implementation_id", "SourceAll",
    "type_name", "SourceAll",
    "description", "Writes a growing number to ports of all basic types",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "example",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "exec_cxt.periodic.rate", "10",
    "conf.default.start", "1",
    "conf.default.length", "3",
    "conf.__widget__.start", "spin",
    "conf.__widget__.length", "spin",
    "conf.__constraints__.length", "0<=x<=1000",
    "conf.__type__.start", "int",
    "conf.__type__.length", "int",
    ""};
// clang-format on

extern "C" {
DLL_EXPORT void SourceAllInit(RTC::Manager* manager) {
  coil::Properties profile(sourceall_spec);
  manager->registerFactory(profile, RTC::Create<SourceAll>, RTC::Delete<SourceAll>);
}
}
