// Sends the log of this process to a logger that a tool attached: consumer of OpenRTM::Logger. The logger is called on a thread of its
// own.
#pragma once

#include <rtm/SdoServiceConsumerBase.h>

namespace RTC {

// Under the repository id of the interface. Calling it again changes nothing.
void registerLoggerConsumer();

}  // namespace RTC
