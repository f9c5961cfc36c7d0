// For servers that are not ours and that we start: what lets only the own account in. Any thread.
#pragma once

#include <string>

namespace base {

// The library for LD_PRELOAD that closes a server's TCP connections from other accounts; it lies beside the library that this function is
// in. Empty when it is not there.
std::string own_account_door();

}  // namespace base
