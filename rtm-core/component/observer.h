// Tells an observer that a tool has attached what happens to the component: consumer of OpenRTM::ComponentObserver (1.x) and of
// RTC::ComponentObserver (2.x). The observer is called on a thread of its own. It hears of profile changes, ports, contexts, configuration
// and state machines by itself; what else a component wants to say it says with RTObject_impl::notifyObservers.
#pragma once

#include <rtm/SdoServiceConsumerBase.h>

namespace RTC {

// Under the repository ids of both interfaces. Calling it again changes nothing.
void registerComponentObserverConsumers();

}  // namespace RTC
