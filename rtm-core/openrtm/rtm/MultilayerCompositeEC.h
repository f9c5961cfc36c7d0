// A periodic context by another name: composites that ask for it get all members run in one thread, one after the other.
#pragma once

#include <rtm/PeriodicExecutionContext.h>

namespace RTC_exp {

class MultilayerCompositeEC : public RTC::PeriodicExecutionContext {
 public:
  MultilayerCompositeEC();
};

}  // namespace RTC_exp

extern "C" void MultilayerCompositeECInit(RTC::Manager* manager);
