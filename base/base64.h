// Base64 (RFC 4648, standard alphabet, with padding). Any thread.
#pragma once

#include <string>
#include <string_view>

namespace base {

std::string to_base64(std::string_view bytes);

// Decodes up to the first character outside the alphabet, which padding is.
std::string from_base64(std::string_view text);

}  // namespace base
