// The specification of a new component, as read from files. Any thread.
#pragma once

#include <string>
#include <vector>

#include "rtse/skeleton/skeleton.h"

namespace tools {

// RTC.xml (RtcProfile, what RTCBuilder saves) or a YAML specification.
base::Result<NewComponent> read_specification(const std::string& file);

// Types of RTC.xml are C++ names, or, in old files, names without a module: those are of RTC.
std::string full_type(const std::string& type);
void add_once(std::vector<std::string>& list, const std::string& item);

}  // namespace tools
