// The byte format of hash logs, for their writer and their reader (docs/hash-logs.md).
#pragma once

#include <string_view>

namespace base::hash_log_format {

// The last octet is the version: another one when the same run gets other hashes.
inline constexpr std::string_view magic = "RTMHASH4";
inline constexpr char oldest_version = '1';
inline constexpr char key_record = 1;
inline constexpr char tick_record = 2;
inline constexpr char end_record = 3;

}  // namespace base::hash_log_format
