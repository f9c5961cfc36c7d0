// Converts samples of any data type of idl/ to text and back: CDR payload -> JSON, by the type code. Pure; any thread.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "rtm/idl/RTCStub.h"

namespace tools {

// "IDL:RTC/TimedLong:1.0" -> its type code; nil when idl/ has no such data type.
CORBA::TypeCode_ptr type_code_of(const std::string& repository_id);
std::vector<std::string> known_data_types();

// Decodes plain CDR (alignment from the first octet). Cut short, with wild lengths, or more than so many values: an error. A value takes
// sixteen octets of memory, its octet in the payload one.
base::Result<nlohmann::ordered_json> decode(CORBA::TypeCode_ptr type, std::span<const unsigned char> payload, bool little_endian = true,
                                            std::size_t max_values = SIZE_MAX);
// Missing members of objects are zero; unknown ones, wrong kinds and values out of range are errors that name the member.
base::Result<std::vector<unsigned char>> encode(CORBA::TypeCode_ptr type, const nlohmann::ordered_json& value, bool little_endian = true);

// "" when the path leads to a number, or as far as the type tells, may; else the names of what is where it fails, or "no more".
std::string member_problem(const std::string& repository_id, const std::vector<std::string>& path);

// The type behind typedefs, which say nothing on the wire.
CORBA::TypeCode_var resolved(CORBA::TypeCode_ptr type);

}  // namespace tools
