// Globally unique identifiers. Any thread.
#pragma once

#include <string>

namespace base {

// A random UUID (RFC 4122, version 4) in its 36-character lower-case form.
std::string make_uuid();

}  // namespace base
