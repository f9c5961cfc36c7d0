#include "rtm/Factory.h"

#include "base/log.h"
#include "rtm/ECFactory.h"
#include "rtm/FactoryInit.h"
#include "rtm/NumberingPolicy.h"
#include "rtm/PeriodicECSharedComposite.h"
#include "rtm/RTObject.h"
#include "rtm/SdoServiceAdmin.h"

namespace RTC {

void releaseComponent(RTObject_impl* rtc) {
  if (rtc != nullptr) rtc->_remove_ref();
}

RTObject_impl* FactoryCXX::create(Manager* manager) {
  try {
    return create_ != nullptr ? create_(manager) : nullptr;
  } catch (const std::exception& e) {
    base::log(base::Level::error, "manager", "creating a {} failed: {}", profile_.getProperty("implementation_id"), e.what());
  } catch (...) {
    base::log(base::Level::error, "manager", "creating a {} failed with an unknown exception", profile_.getProperty("implementation_id"));
  }
  return nullptr;
}

void FactoryCXX::destroy(RTObject_impl* component) {
  try {
    if (destroy_ != nullptr) destroy_(component);
  } catch (...) {
    base::log(base::Level::error, "manager", "deleting a {} failed with an exception", profile_.getProperty("implementation_id"));
  }
}

}  // namespace RTC

void FactoryInit(RTC::Manager* manager) {
  RTC::registerBuiltinExecutionContexts(manager);
  RTC::registerBuiltinSdoServices();
  auto& policies = RTM::NumberingPolicyFactory::instance();
  using RTM::NumberingPolicyBase;
  policies.addFactory("process_unique", coil::Creator<NumberingPolicyBase, RTM::ProcessUniquePolicy>,
                      coil::Destructor<NumberingPolicyBase, RTM::ProcessUniquePolicy>);
  policies.addFactory("node_unique", coil::Creator<NumberingPolicyBase, RTM::NodeNumberingPolicy>,
                      coil::Destructor<NumberingPolicyBase, RTM::NodeNumberingPolicy>);
  policies.addFactory("ns_unique", coil::Creator<NumberingPolicyBase, RTM::NamingServiceNumberingPolicy>,
                      coil::Destructor<NumberingPolicyBase, RTM::NamingServiceNumberingPolicy>);
  PeriodicECSharedCompositeInit(manager);
}
