// For servers that are not ours and that we start: what lets only the own account in. Any thread.
#pragma once

#include <string>

namespace base {

// The library for LD_PRELOAD that closes a server's TCP connections from other accounts; it lies beside the library that this function is
// in. Empty when it is not there.
std::string own_account_door();

// What omniNames is started with besides. Of omniORB 4.2 several threads of one connection use memory that is free already when messages
// come in fragments as it does not expect them; a naming service calls nobody, so nothing of it waits for a second thread.
inline constexpr const char* one_thread_a_connection[] = {"-ORBmaxServerThreadPerConnection", "1"};

}  // namespace base
