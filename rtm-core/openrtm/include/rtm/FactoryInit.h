// Called once by the manager: registers the execution contexts, numbering policies and composite components that come with the library.
#pragma once

namespace RTC {
class Manager;
}

void FactoryInit(RTC::Manager* manager);
