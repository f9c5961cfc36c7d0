// Servers of the own account: where they are, and the library that restricts third-party ones, such as omniNames, to it. Any thread.
#pragma once

#include <string>
#include <string_view>

namespace base {

// The library for LD_PRELOAD that closes a server's TCP connections from other accounts, and hands it whole GIOP messages; it lies beside
// the library that this function is in. Empty when it is not there.
std::string own_account_door();

// What omniNames is started with besides. Of omniORB 4.2 several threads of one connection use memory that is free already when messages
// come in fragments as it does not expect them; a naming service calls nobody, so nothing of it waits for a second thread. With a time
// limit for a call, which its user may have set for all programs, it would look for the rest of a message at the connection, where nothing
// is any more.
inline constexpr const char* naming_options[] = {"-ORBmaxServerThreadPerConnection", "1", "-ORBserverCallTimeOutPeriod", "0"};

// HOST[:PORT], perhaps behind "iiop:" or "ssliop:", with 127.0.0.1 for localhost. That name has an address of IPv6, too, which is asked
// first on most machines: where a server uses the other one alone, any account can listen at ::1 and would get the calls.
std::string with_numeric_host(std::string_view address);

}  // namespace base
