// First header of the component API: the interfaces of the RTC standard and the names authors use for them. Any thread.
#pragma once

#include <coil/config_coil.h>
#include <rtm/config_rtc.h>
#include <rtm/version.h>

#include <rtm/idl/RTCSkel.h>

// Sources of every age count on these coming along.
#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace coil {
class Properties;
}

namespace RTC {

using Properties = coil::Properties;
using UniqueId = ExecutionContextHandle_t;

class RTObject_impl;
using RtcBase = RTObject_impl;

}  // namespace RTC
