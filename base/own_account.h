// The library that restricts third-party servers, such as omniNames, to the own account. Any thread.
#pragma once

#include <string>

namespace base {

// The library for LD_PRELOAD that closes a server's TCP connections from other accounts, and hands it whole GIOP messages; it lies beside
// the library that this function is in. Empty when it is not there.
std::string own_account_door();

// What omniNames is started with besides. Of omniORB 4.2 several threads of one connection use memory that is free already when messages
// come in fragments as it does not expect them; a naming service calls nobody, so nothing of it waits for a second thread. With a time
// limit for a call, which its user may have set for all programs, it would look for the rest of a message at the connection, where nothing
// is any more.
inline constexpr const char* naming_options[] = {"-ORBmaxServerThreadPerConnection", "1", "-ORBserverCallTimeOutPeriod", "0"};

}  // namespace base
