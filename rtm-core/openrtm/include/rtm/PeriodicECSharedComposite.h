// A component that consists of other components: these members run in its execution context, follow its state, and some of their ports
// become its own (configuration parameter exported_ports: a comma list of <member>.<port>).
#pragma once

#include <rtm/DataFlowComponentBase.h>

#include <string>
#include <vector>

namespace SDOPackage {
class PeriodicECOrganization;
}

namespace RTC {

class PeriodicECSharedComposite : public DataFlowComponentBase {
 public:
  explicit PeriodicECSharedComposite(Manager* manager);
  ~PeriodicECSharedComposite() override;

  ReturnCode_t onInitialize() override;
  ReturnCode_t onActivated(RTC::UniqueId exec_handle) override;
  ReturnCode_t onDeactivated(RTC::UniqueId exec_handle) override;
  ReturnCode_t onReset(RTC::UniqueId exec_handle) override;
  ReturnCode_t onFinalize() override;

 private:
  std::vector<std::string> members_;
  SDOPackage::PeriodicECOrganization* organization_ = nullptr;  // a servant; this object holds one reference
};

}  // namespace RTC

extern "C" void PeriodicECSharedCompositeInit(RTC::Manager* manager);
