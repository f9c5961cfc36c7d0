// SHA-256, for type hashes. Pure; any thread.
#pragma once

#include <string>
#include <string_view>

namespace ros {

// 64 hexadecimal digits.
std::string sha256(std::string_view text);

}  // namespace ros
