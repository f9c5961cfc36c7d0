// Numbers components of one type: ConsoleIn0, ConsoleIn1, ... Policies are picked by manager.components.naming_policy; own ones are
// registered with NumberingPolicyFactory. The manager calls a policy from one thread at a time.
#pragma once

#include <coil/Factory.h>

#include <string>

namespace RTM {

class NumberingPolicyBase {
 public:
  virtual ~NumberingPolicyBase() = default;
  // The number for a new component (an RTC::RTObject_impl*, its type name set).
  virtual std::string onCreate(void* object) = 0;
  virtual void onDelete(void* object) = 0;
};

using NumberingPolicyFactory = coil::GlobalFactory<NumberingPolicyBase>;

}  // namespace RTM

using NumberingPolicy = RTM::NumberingPolicyBase;
