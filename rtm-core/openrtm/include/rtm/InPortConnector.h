// RTC::InPortConnector, for sources that include the header of that name.
#pragma once

#include <rtm/ConnectorBase.h>
