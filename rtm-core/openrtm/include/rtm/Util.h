// Small conversions that sources of the 1.x series include. Any thread.
#pragma once

#include <coil/Properties.h>
#include <coil/stringutil.h>
#include <rtm/RTC.h>

#include <string>
#include <vector>

namespace RTC {

// The items of a comma list as a sequence of CORBA strings, and back.
SDOPackage::StringList toStringList(const coil::vstring& list);
coil::vstring toVector(const SDOPackage::StringList& list);

}  // namespace RTC
