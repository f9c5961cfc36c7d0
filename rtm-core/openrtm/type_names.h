// Names of the enumerators of the classic API.
#pragma once

#include <cstddef>

namespace RTC {

// The word of `type`; "" for what is none of them.
template <std::size_t size>
const char* name_of(const char* const (&names)[size], int type) {
  return type >= 0 && static_cast<std::size_t>(type) < size ? names[type] : "";
}

}  // namespace RTC
