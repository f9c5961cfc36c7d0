// Reads values as users type them at `rtse inject`, by a type code. Pure; any thread.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "base/result.h"
#include "rtm/idl/RTCStub.h"

namespace tools {

// JSON (a number, string or array for a Timed type means its data; the time stamp is then `now_ns`), or the form of
// rtinject: RTC.TimedLong({time}, 42), members in order, nested.
base::Result<nlohmann::ordered_json> parse_value(CORBA::TypeCode_ptr type, const std::string& text, std::int64_t now_ns);

}  // namespace tools
