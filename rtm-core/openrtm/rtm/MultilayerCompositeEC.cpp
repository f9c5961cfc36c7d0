#include <rtm/ECFactory.h>
#include <rtm/MultilayerCompositeEC.h>

namespace RTC_exp {

MultilayerCompositeEC::MultilayerCompositeEC() : PeriodicExecutionContext("multilayercomposite_ec") {}

}  // namespace RTC_exp

extern "C" void MultilayerCompositeECInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("MultilayerCompositeEC", RTC::ECCreate<RTC_exp::MultilayerCompositeEC>,
                                                      RTC::ECDelete<RTC_exp::MultilayerCompositeEC>);
}
