// Transports of data ports that come as a module of their own: a port shows them while the module is there, and loads it when the first
// connection asks for one. The module is found as others are: in manager.modules.load_path, then where this library's modules are
// installed. Any thread; no lock is held while the module is loaded.
#pragma once

#include <string>
#include <vector>

namespace RTC::detail {

// Those whose module is there, loaded or not. The folders are looked at every 5 s at most.
std::vector<std::string> transports_of_modules();

// Loads the module of a transport. Why it is not there, in words that continue a sentence; empty when it is there, or is of no module.
std::string load_transport_module(const std::string& transport);

}  // namespace RTC::detail
