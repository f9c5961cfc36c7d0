// What the specifications of interface components have in common. Any thread.
#pragma once

#include <coil/Properties.h>

#include <string>

namespace iface {

inline constexpr int highest_server = 9999;

// The simulator that is meant when nobody names one: RTMSIM_SERVER_ID, as for the simulator and its tools, else 0. A value that is none is
// said once and counts as 0.
int default_server();

// The properties of a type; its conf.default.server_id is default_server().
coil::Properties specification(const char* const spec[]);

}  // namespace iface
