// Results of the runtime's operations: the OMG RTC return codes, with the numbers of the wire. Any thread. Source: OMG Robotic Technology
// Component 1.1, 5.2.1.
#pragma once

#include <string_view>

namespace rt {

enum class ReturnCode { ok = 0, error = 1, bad_parameter = 2, unsupported = 3, out_of_resources = 4, precondition_not_met = 5 };

// "RTC_OK", "BAD_PARAMETER", ...
std::string_view to_text(ReturnCode code);

}  // namespace rt
