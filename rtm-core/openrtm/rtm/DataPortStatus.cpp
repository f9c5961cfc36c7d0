#include "rtm/DataPortStatus.h"

#include <ostream>

#include "core/port_status.h"

namespace RTC {

const char* DataPortStatus::toString(DataPortStatus status) { return rt::to_text(static_cast<rt::PortStatus>(status.value_)).data(); }

std::ostream& operator<<(std::ostream& out, DataPortStatus status) { return out << toString(status); }

}  // namespace RTC
