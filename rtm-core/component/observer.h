// Notifies an observer that a tool attached of changes of the component: consumer of OpenRTM::ComponentObserver (1.x) and
// RTC::ComponentObserver (2.x). The observer is called on a thread of its own. Changes of profile, ports, contexts, configuration and state
// machines are reported automatically, others by RTObject_impl::notifyObservers.
#pragma once

#include <rtm/SdoServiceConsumerBase.h>

namespace RTC {

// The interface type of a service profile whose service is an OpenRTM::Logger that wants events, not lines: the record's logger is the kind
// (RTC_STATUS, ...), its message what observers are told, with "=VALUE" for a parameter, its time that of the tick in which it happened
// (level RTM_INFO), or of the clock between ticks (RTM_NORMAL).
inline constexpr const char* event_log_type = "rtm-sim/EventLog:1.0";

// Under the repository ids of both interfaces. Calling it again changes nothing.
void registerComponentObserverConsumers();

}  // namespace RTC
