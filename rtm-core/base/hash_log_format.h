// The octets of hash logs, for their writer and their reader; docs/hash-logs.md describes them.
#pragma once

#include <string_view>

namespace base::hash_log_format {

inline constexpr std::string_view magic = "RTMHASH1";
inline constexpr char key_record = 1;
inline constexpr char tick_record = 2;
inline constexpr char end_record = 3;

}  // namespace base::hash_log_format
